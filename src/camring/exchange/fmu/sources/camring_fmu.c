/* A radial-piston motor as an FMU for co-simulation, FMI 2.0.

   Inputs: shaft speed, the two port pressures, case pressure. Outputs: torque, flows, angle.
   The angle is the integral of the speed, which is held over a step; everything else is looked
   up in the table. Outputs always belong to the inputs that were set last. */
#ifdef _MSC_VER
#define _CRT_SECURE_NO_WARNINGS
#endif
#include "camring_fmi2.h"
#include "camring_model.h"
#include "camring_table.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SPEED, SUPPLY_PRESSURE, RETURN_PRESSURE, CASE_PRESSURE, INPUTS,
    TORQUE = INPUTS, SUPPLY_FLOW, RETURN_FLOW, CASE_FLOW, ANGLE, INITIAL_ANGLE, REALS,
    RIPPLE = REALS
};

typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED } Mode;
enum { BIT_INSTANTIATED = 1, BIT_INITIALIZING = 2, BIT_STEPPING = 4, BIT_ANY = 15 };

/* All that changes while simulating: what fmi2GetFMUstate saves. */
typedef struct {
    Mode mode;
    fmi2Real input[INPUTS];
    fmi2Real initial_angle, angle, time;
    fmi2Boolean ripple;
    unsigned reported;  /* sides of the table beyond which an input was reported */
} Memory;

typedef struct {
    Memory memory;
    CamringTable *table;
    fmi2CallbackFunctions functions;
    char *name;
} Instance;

static void tell(const Instance *self, fmi2Status status, const char *format, ...)
{
    char message[512];
    va_list arguments;
    if (!self->functions.logger) return;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    self->functions.logger(self->functions.componentEnvironment, self->name, status,
                           status == fmi2Warning ? "logStatusWarning" : "logStatusError",
                           "%s", message);
}

static int wrong_call(const Instance *self, unsigned allowed, const char *function)
{
    static const char *const names[] = {"before initialization", "in initialization mode",
                                        "while stepping", "after termination"};
    if (!self) return 1;
    if (allowed >> self->memory.mode & 1) return 0;
    tell(self, fmi2Error, "%s must not be called %s", function, names[self->memory.mode]);
    return 1;
}

static fmi2Status unsupported(const Instance *self, const char *function)
{
    if (self) tell(self, fmi2Error, "%s is not supported", function);
    return fmi2Error;
}

static fmi2Status unknown(const Instance *self, fmi2ValueReference which, const char *function)
{
    tell(self, fmi2Error, "%s: no such variable has the value reference %u", function, which);
    return fmi2Error;
}

static void start(Memory *memory)
{
    static const fmi2Real input[INPUTS] = CAMRING_START;
    memset(memory, 0, sizeof *memory);
    memcpy(memory->input, input, sizeof input);
    memory->ripple = fmi2True;
}

static void report_held(Instance *self, unsigned held)
{
    static const char *const names[CAMRING_AXES] = {
        "speed (rad/s)", "supplyPressure - returnPressure (Pa)",
        "lower port pressure - casePressure (Pa)"};
    const unsigned fresh = held & ~self->memory.reported;
    const Memory *memory = &self->memory;
    CamringInputs inputs = {0, 0, 0, 0, 0, 0};
    double coordinate[CAMRING_AXES], range[2];
    int axis;
    if (!fresh) return;
    inputs.speed = memory->input[SPEED];
    inputs.supply_pressure = memory->input[SUPPLY_PRESSURE];
    inputs.return_pressure = memory->input[RETURN_PRESSURE];
    inputs.case_pressure = memory->input[CASE_PRESSURE];
    camring_coordinates(&inputs, coordinate);
    for (axis = 0; axis < CAMRING_AXES; axis++)
        if (fresh >> (2 * axis) & 3) {
            camring_table_range(self->table, axis, range);
            tell(self, fmi2Warning,
                 "at time %g s %s is %g, outside the table's %g to %g: it is held at the edge; "
                 "this is said once", memory->time, names[axis], coordinate[axis], range[0],
                 range[1]);
        }
    self->memory.reported |= held;
}

static void outputs(Instance *self, double result[CAMRING_QUANTITIES])
{
    const Memory *memory = &self->memory;
    CamringInputs inputs;
    unsigned held;
    inputs.speed = memory->input[SPEED];
    inputs.supply_pressure = memory->input[SUPPLY_PRESSURE];
    inputs.return_pressure = memory->input[RETURN_PRESSURE];
    inputs.case_pressure = memory->input[CASE_PRESSURE];
    inputs.angle = memory->angle;
    inputs.ripple = memory->ripple;
    held = camring_table_look_up(self->table, &inputs, result);
    if (memory->mode == STEPPING) report_held(self, held);
}

/* The value of a hexadecimal digit, or -1. */
static int digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/* The path of a file URI with a file's name behind it; empty where it does not fit. */
static void path_of(const char *uri, const char *file, char *path, size_t size)
{
    size_t length = 0;
    if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (uri[0] == '/' && uri[1] == '/')
            for (uri += 2; *uri && *uri != '/';) uri++;
        if (uri[0] == '/' && uri[1] && uri[2] == ':') uri++;  /* /C:/folder */
    }
    while (*uri && length + 1 < size) {
        if (uri[0] == '%' && digit(uri[1]) >= 0 && digit(uri[2]) >= 0) {
            path[length++] = (char)(16 * digit(uri[1]) + digit(uri[2]));
            uri += 3;
        } else
            path[length++] = *uri++;
    }
    while (length > 0 && path[length - 1] == '/') length--;
    if (*uri || length + strlen(file) + 2 > size) {
        path[0] = 0;
        return;
    }
    path[length++] = '/';
    strcpy(path + length, file);
}

const char *FMI2_NAME(fmi2GetTypesPlatform)(void) { return "default"; }

const char *FMI2_NAME(fmi2GetVersion)(void) { return "2.0"; }

fmi2Component FMI2_NAME(fmi2Instantiate)(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    char path[4096], message[512];
    Instance *self, asked;
    (void)visible;
    (void)logging;  /* there are warnings and errors only, and these are always reported */

    if (!functions) return NULL;
    asked.functions = *functions;
    asked.name = (char *)"";
    if (!name || !*name) {
        tell(&asked, fmi2Error, "fmi2Instantiate needs a name for the instance");
        return NULL;
    }
    if (type != fmi2CoSimulation) {
        tell(&asked, fmi2Error, "this FMU is for co-simulation only");
        return NULL;
    }
    if (!guid || strcmp(guid, CAMRING_GUID) != 0) {
        tell(&asked, fmi2Error, "the GUID of modelDescription.xml is not that of this FMU");
        return NULL;
    }
    if (!resources) {
        tell(&asked, fmi2Error, "fmi2Instantiate needs the folder of the resources");
        return NULL;
    }
    self = calloc(1, sizeof *self);
    if (self) self->name = malloc(strlen(name) + 1);
    if (!self || !self->name) {
        free(self);
        tell(&asked, fmi2Error, "there is no memory for an instance");
        return NULL;
    }
    strcpy(self->name, name);
    self->functions = *functions;
    start(&self->memory);
    path_of(resources, "table.bin", path, sizeof path);
    self->table = camring_table_open(path, message, sizeof message);
    if (!self->table) {
        tell(self, fmi2Error, "%s", message);
        FMI2_NAME(fmi2FreeInstance)(self);
        return NULL;
    }
    return self;
}

void FMI2_NAME(fmi2FreeInstance)(fmi2Component c)
{
    Instance *self = c;
    if (!self) return;
    camring_table_close(self->table);
    free(self->name);
    free(self);
}

FMI2_STATUS(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                 const fmi2String categories[])
{
    (void)on;
    (void)count;
    (void)categories;
    return wrong_call(c, BIT_ANY, "fmi2SetDebugLogging") ? fmi2Error : fmi2OK;
}

FMI2_STATUS(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined,
                                 fmi2Real tolerance, fmi2Real start_time,
                                 fmi2Boolean stop_defined, fmi2Real stop)
{
    Instance *self = c;
    (void)tolerance_defined;
    (void)tolerance;
    (void)stop_defined;
    (void)stop;
    if (wrong_call(self, BIT_INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    self->memory.time = start_time;
    return fmi2OK;
}

FMI2_STATUS(fmi2EnterInitializationMode)(fmi2Component c)
{
    Instance *self = c;
    if (wrong_call(self, BIT_INSTANTIATED, "fmi2EnterInitializationMode")) return fmi2Error;
    self->memory.mode = INITIALIZING;
    return fmi2OK;
}

FMI2_STATUS(fmi2ExitInitializationMode)(fmi2Component c)
{
    Instance *self = c;
    if (wrong_call(self, BIT_INITIALIZING, "fmi2ExitInitializationMode")) return fmi2Error;
    self->memory.mode = STEPPING;
    return fmi2OK;
}

FMI2_STATUS(fmi2Terminate)(fmi2Component c)
{
    Instance *self = c;
    if (wrong_call(self, BIT_STEPPING, "fmi2Terminate")) return fmi2Error;
    self->memory.mode = TERMINATED;
    return fmi2OK;
}

FMI2_STATUS(fmi2Reset)(fmi2Component c)
{
    Instance *self = c;
    if (wrong_call(self, BIT_ANY, "fmi2Reset")) return fmi2Error;
    start(&self->memory);
    return fmi2OK;
}

FMI2_STATUS(fmi2GetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                         fmi2Real value[])
{
    Instance *self = c;
    double result[CAMRING_QUANTITIES];
    int looked_up = 0;
    size_t i;
    if (wrong_call(self, BIT_ANY, "fmi2GetReal")) return fmi2Error;
    for (i = 0; i < count; i++) {
        const fmi2ValueReference number = which[i];
        if (number >= REALS) return unknown(self, number, "fmi2GetReal");
        if (number < INPUTS)
            value[i] = self->memory.input[number];
        else if (number == ANGLE)
            value[i] = self->memory.angle;
        else if (number == INITIAL_ANGLE)
            value[i] = self->memory.initial_angle;
        else {
            if (!looked_up) outputs(self, result);
            looked_up = 1;
            value[i] = result[number - TORQUE];
        }
    }
    return fmi2OK;
}

FMI2_STATUS(fmi2SetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                         const fmi2Real value[])
{
    Instance *self = c;
    size_t i;
    if (wrong_call(self, BIT_INSTANTIATED | BIT_INITIALIZING | BIT_STEPPING, "fmi2SetReal"))
        return fmi2Error;
    for (i = 0; i < count; i++) {
        const fmi2ValueReference number = which[i];
        if (number >= REALS) return unknown(self, number, "fmi2SetReal");
        if (number >= INPUTS && number != INITIAL_ANGLE) {
            tell(self, fmi2Error, "fmi2SetReal: variable %u is an output", number);
            return fmi2Error;
        }
        if (!isfinite(value[i])) {
            tell(self, fmi2Error, "fmi2SetReal: variable %u must be finite", number);
            return fmi2Error;
        }
        if (number < INPUTS)
            self->memory.input[number] = value[i];
        else if (self->memory.mode == STEPPING) {
            tell(self, fmi2Error, "initialAngle cannot be set after initialization");
            return fmi2Error;
        } else
            self->memory.initial_angle = self->memory.angle = value[i];
    }
    return fmi2OK;
}

FMI2_STATUS(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            fmi2Boolean value[])
{
    Instance *self = c;
    size_t i;
    if (wrong_call(self, BIT_ANY, "fmi2GetBoolean")) return fmi2Error;
    for (i = 0; i < count; i++) {
        if (which[i] != RIPPLE) return unknown(self, which[i], "fmi2GetBoolean");
        value[i] = self->memory.ripple;
    }
    return fmi2OK;
}

FMI2_STATUS(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            const fmi2Boolean value[])
{
    Instance *self = c;
    size_t i;
    if (wrong_call(self, BIT_INSTANTIATED | BIT_INITIALIZING | BIT_STEPPING, "fmi2SetBoolean"))
        return fmi2Error;
    for (i = 0; i < count; i++) {
        if (which[i] != RIPPLE) return unknown(self, which[i], "fmi2SetBoolean");
        self->memory.ripple = value[i] ? fmi2True : fmi2False;
    }
    return fmi2OK;
}

/* There are no integers and no strings: asking for none of them is right. */
static fmi2Status none(const Instance *self, const fmi2ValueReference which[], size_t count,
                       const char *function)
{
    if (wrong_call(self, BIT_ANY, function)) return fmi2Error;
    return count ? unknown(self, which[0], function) : fmi2OK;
}

FMI2_STATUS(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            fmi2Integer value[])
{
    (void)value;
    return none(c, which, count, "fmi2GetInteger");
}

FMI2_STATUS(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            const fmi2Integer value[])
{
    (void)value;
    return none(c, which, count, "fmi2SetInteger");
}

FMI2_STATUS(fmi2GetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                           fmi2String value[])
{
    (void)value;
    return none(c, which, count, "fmi2GetString");
}

FMI2_STATUS(fmi2SetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                           const fmi2String value[])
{
    (void)value;
    return none(c, which, count, "fmi2SetString");
}

FMI2_STATUS(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_way_back)
{
    Instance *self = c;
    double result[CAMRING_QUANTITIES];
    Memory *memory;
    (void)no_way_back;
    if (wrong_call(self, BIT_STEPPING, "fmi2DoStep")) return fmi2Error;
    memory = &self->memory;
    if (!(isfinite(step) && step >= 0)) {
        tell(self, fmi2Error, "fmi2DoStep: the step of %g s must be finite and not negative", step);
        return fmi2Error;
    }
    if (!(fabs(time - memory->time) <= 1e-6 * step + 1e-9 * fabs(time))) {
        tell(self, fmi2Error, "fmi2DoStep: begins at %.12g s, but the last step ended at %.12g s",
             time, memory->time);
        return fmi2Error;
    }
    outputs(self, result);  /* reports inputs outside the table with the time at which they were */
    memory->angle += memory->input[SPEED] * step;
    memory->time = time + step;
    return fmi2OK;
}

FMI2_STATUS(fmi2CancelStep)(fmi2Component c) { return unsupported(c, "fmi2CancelStep"); }

FMI2_STATUS(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    Instance *self = c;
    if (wrong_call(self, BIT_ANY, "fmi2GetFMUstate") || !state) return fmi2Error;
    if (!*state) *state = malloc(sizeof(Memory));
    if (!*state) return fmi2Error;
    memcpy(*state, &self->memory, sizeof(Memory));
    return fmi2OK;
}

FMI2_STATUS(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    Instance *self = c;
    if (wrong_call(self, BIT_ANY, "fmi2SetFMUstate") || !state) return fmi2Error;
    memcpy(&self->memory, state, sizeof(Memory));
    return fmi2OK;
}

FMI2_STATUS(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    if (wrong_call(c, BIT_ANY, "fmi2FreeFMUstate") || !state) return fmi2Error;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

FMI2_STATUS(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    if (wrong_call(c, BIT_ANY, "fmi2SerializedFMUstateSize") || !state || !size) return fmi2Error;
    *size = sizeof(Memory);
    return fmi2OK;
}

FMI2_STATUS(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                   size_t size)
{
    if (wrong_call(c, BIT_ANY, "fmi2SerializeFMUstate") || !state || size < sizeof(Memory))
        return fmi2Error;
    memcpy(bytes, state, sizeof(Memory));
    return fmi2OK;
}

FMI2_STATUS(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                     fmi2FMUstate *state)
{
    if (wrong_call(c, BIT_ANY, "fmi2DeSerializeFMUstate") || !state || size != sizeof(Memory))
        return fmi2Error;
    if (!*state) *state = malloc(sizeof(Memory));
    if (!*state) return fmi2Error;
    memcpy(*state, bytes, sizeof(Memory));
    return fmi2OK;
}

FMI2_STATUS(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknowns[],
                                          size_t unknown_count,
                                          const fmi2ValueReference knowns[], size_t known_count,
                                          const fmi2Real seed[], fmi2Real derivative[])
{
    (void)unknowns;
    (void)unknown_count;
    (void)knowns;
    (void)known_count;
    (void)seed;
    (void)derivative;
    return unsupported(c, "fmi2GetDirectionalDerivative");
}

FMI2_STATUS(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                         size_t count, const fmi2Integer order[],
                                         const fmi2Real value[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)value;
    return unsupported(c, "fmi2SetRealInputDerivatives");
}

FMI2_STATUS(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                          size_t count, const fmi2Integer order[],
                                          fmi2Real value[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)value;
    return unsupported(c, "fmi2GetRealOutputDerivatives");
}

/* Only for steps that go on by themselves, which none does. */
FMI2_STATUS(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return unsupported(c, "fmi2GetStatus");
}

FMI2_STATUS(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Instance *self = c;
    if (wrong_call(self, BIT_ANY, "fmi2GetRealStatus") || !value) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return unsupported(self, "fmi2GetRealStatus");
    *value = self->memory.time;
    return fmi2OK;
}

FMI2_STATUS(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return unsupported(c, "fmi2GetIntegerStatus");
}

FMI2_STATUS(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)kind;
    (void)value;
    return unsupported(c, "fmi2GetBooleanStatus");
}

FMI2_STATUS(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return unsupported(c, "fmi2GetStringStatus");
}
