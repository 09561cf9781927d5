/* The smallest FMU for co-simulation (FMI 2.0): torque = level + height sin(speed t).
 * mood 1 crashes, 2 never comes back, 3 answers NaN, 4 refuses the step. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEVEL, HEIGHT, SPEED, MOOD, TORQUE, COUNT };
typedef struct {
    double values[COUNT];
    double time;
} Waves;

void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *where,
                      const void *functions, int visible, int logging)
{
    (void)name, (void)kind, (void)guid, (void)where, (void)functions;
    (void)visible, (void)logging;
    printf("Hello from native code, which must not stand in the answer\n");
    fflush(stdout);
    return calloc(1, sizeof(Waves));
}
void fmi2FreeInstance(void *it) { free(it); }
int fmi2SetupExperiment(void *it, int a, double b, double from, int c, double d)
{
    (void)it, (void)a, (void)b, (void)from, (void)c, (void)d;
    return 0;
}
int fmi2EnterInitializationMode(void *it) { return (void)it, 0; }
int fmi2ExitInitializationMode(void *it) { return (void)it, 0; }
int fmi2Terminate(void *it) { return (void)it, 0; }
int fmi2SetReal(void *it, const unsigned *which, size_t count, const double *values)
{
    for (size_t k = 0; k < count; k++) ((Waves *)it)->values[which[k]] = values[k];
    return 0;
}
int fmi2GetReal(void *it, const unsigned *which, size_t count, double *values)
{
    Waves *waves = it;
    double *now = waves->values;
    now[TORQUE] = now[LEVEL] + now[HEIGHT] * sin(now[SPEED] * waves->time);
    if (now[MOOD] == 3) now[TORQUE] = NAN;
    for (size_t k = 0; k < count; k++) values[k] = now[which[k]];
    return 0;
}
int fmi2DoStep(void *it, double time, double step, int keep)
{
    Waves *waves = it;
    (void)keep;
    if (waves->values[MOOD] == 1) abort();
    for (volatile int forever = waves->values[MOOD] == 2; forever;) { }
    if (waves->values[MOOD] == 4) return 3;
    waves->time = time + step;
    return 0;
}

/* FMPy looks for all of these, and calls none of them here. */
#define UNUSED(name) int fmi2##name(void) { return 3; }
UNUSED(CancelStep)
UNUSED(DeSerializeFMUstate)
UNUSED(FreeFMUstate)
UNUSED(GetBoolean)
UNUSED(GetBooleanStatus)
UNUSED(GetDirectionalDerivative)
UNUSED(GetFMUstate)
UNUSED(GetInteger)
UNUSED(GetIntegerStatus)
UNUSED(GetRealOutputDerivatives)
UNUSED(GetRealStatus)
UNUSED(GetStatus)
UNUSED(GetString)
UNUSED(GetStringStatus)
UNUSED(GetTypesPlatform)
UNUSED(GetVersion)
UNUSED(Reset)
UNUSED(SerializeFMUstate)
UNUSED(SerializedFMUstateSize)
UNUSED(SetBoolean)
UNUSED(SetDebugLogging)
UNUSED(SetFMUstate)
UNUSED(SetInteger)
UNUSED(SetRealInputDerivatives)
UNUSED(SetString)
