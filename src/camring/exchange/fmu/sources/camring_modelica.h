/* The table for Modelica's external functions; included by the Modelica compiler. */
#ifndef CAMRING_MODELICA_H
#define CAMRING_MODELICA_H

#define CAMRING_LINKAGE static
#include "ModelicaUtilities.h"
#include "camring_table.c"

typedef struct {
    CamringTable *table;
    unsigned reported;  /* sides of the table beyond which an input was reported */
} CamringModelica;

static void *camring_modelica_open(const char *path)
{
    char message[512];
    CamringModelica *self = calloc(1, sizeof *self);
    if (!self) ModelicaError("There is no memory for the motor's table");
    self->table = camring_table_open(path, message, sizeof message);
    if (!self->table) {
        free(self);
        ModelicaFormatError("%s", message);
    }
    return self;
}

static void camring_modelica_close(void *motor)
{
    CamringModelica *self = motor;
    if (!self) return;
    camring_table_close(self->table);
    free(self);
}

static void camring_modelica_look_up(void *motor, double speed, double supply_pressure,
                                     double return_pressure, double case_pressure, double angle,
                                     int ripple, double *result)
{
    static const char *const names[CAMRING_AXES] = {
        "speed (rad/s)", "supplyPressure - returnPressure (Pa)",
        "lower port pressure - casePressure (Pa)"};
    CamringModelica *self = motor;
    CamringInputs inputs;
    double coordinate[CAMRING_AXES], range[2];
    unsigned held;
    int axis;
    inputs.speed = speed;
    inputs.supply_pressure = supply_pressure;
    inputs.return_pressure = return_pressure;
    inputs.case_pressure = case_pressure;
    inputs.angle = angle;
    inputs.ripple = ripple;
    held = camring_table_look_up(self->table, &inputs, result);
    camring_coordinates(&inputs, coordinate);
    for (axis = 0; axis < CAMRING_AXES; axis++)
        if ((held & ~self->reported) >> (2 * axis) & 3) {
            camring_table_range(self->table, axis, range);
            ModelicaFormatMessage("%s is %g, outside the table's %g to %g: it is held at the "
                                  "edge; this is said once\n",
                                  names[axis], coordinate[axis], range[0], range[1]);
        }
    self->reported |= held;
}

#endif
