/* Torque and port flows of a radial-piston motor, looked up in a table that camring made.

   Plain C99; knows nothing of FMI or Modelica. All numbers are SI, pressures absolute. */
#ifndef CAMRING_TABLE_H
#define CAMRING_TABLE_H

/* Whoever includes the .c file can keep its functions to himself: `static`. */
#ifndef CAMRING_LINKAGE
#define CAMRING_LINKAGE
#endif

enum { CAMRING_TORQUE, CAMRING_SUPPLY_FLOW, CAMRING_RETURN_FLOW, CAMRING_CASE_FLOW,
       CAMRING_QUANTITIES };

/* The three coordinates of the table. */
enum { CAMRING_SPEED, CAMRING_DROP, CAMRING_LOW, CAMRING_AXES };

typedef struct {
    double speed;            /* rad/s, signed */
    double supply_pressure;  /* Pa */
    double return_pressure;
    double case_pressure;
    double angle;            /* rad, any real */
    int ripple;              /* zero for means over a revolution */
} CamringInputs;

typedef struct CamringTable CamringTable;

/* The table in a file, or NULL with a sentence in message. */
CAMRING_LINKAGE CamringTable *camring_table_open(const char *path, char *message,
                                                 unsigned long size);
CAMRING_LINKAGE void camring_table_close(CamringTable *table);

/* Ends of an axis, lowest and highest. */
CAMRING_LINKAGE void camring_table_range(const CamringTable *table, int axis, double range[2]);

/* Where the inputs stand on the axes: speed, pressure drop, lower port pressure above case. */
CAMRING_LINKAGE void camring_coordinates(const CamringInputs *inputs, double coordinate[CAMRING_AXES]);

/* Torque on the shaft (N.m), flow into the supply port, out of the return port and out of the
   case (m3/s). Coordinates beyond the table are held at its edge; the result has bit 2 a set
   where axis a was held at its low end, bit 2 a + 1 where it was held at its high end. */
CAMRING_LINKAGE unsigned camring_table_look_up(const CamringTable *table,
                                               const CamringInputs *inputs,
                                               double result[CAMRING_QUANTITIES]);

#endif
