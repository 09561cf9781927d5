/* An importer in C, for sanitizers and stopwatch: two instances of an FMU over and beyond its
   table, states saved and restored, calls that must be refused. Prints the time of a step.

   cc -std=c99 -I SOURCES fmu_driver.c SOURCES/camring_fmu.c SOURCES/camring_table.c -lm
   ./a.out file:///FOLDER/resources STEPS */
#include "camring_fmi2.h"
#include "camring_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static int reported;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    (void)message;
    reported++;
}

static fmi2Component started(const char *resources, const fmi2CallbackFunctions *functions)
{
    fmi2Component motor = fmi2Instantiate("motor", fmi2CoSimulation, CAMRING_GUID, resources,
                                          functions, fmi2False, fmi2False);
    if (!motor) exit(2);
    fmi2SetupExperiment(motor, fmi2False, 0, 0, fmi2False, 0);
    fmi2EnterInitializationMode(motor);
    fmi2ExitInitializationMode(motor);
    return motor;
}

int main(int count, char **given)
{
    static const fmi2ValueReference inputs[] = {0, 1, 2, 3}, outputs[] = {4, 5, 6, 7, 8};
    const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, NULL};
    const long steps = count > 2 ? atol(given[2]) : 1000;
    fmi2Real input[4] = {0, 0, 1e6, 2e5}, output[5] = {0};
    fmi2FMUstate state = NULL, copy = NULL;
    fmi2Component one, other;
    fmi2Byte bytes[1024];
    size_t size = 0;
    clock_t begun;
    long i;

    if (count < 2) return 2;
    if (fmi2Instantiate("motor", fmi2CoSimulation, CAMRING_GUID, "file:///nowhere%2", &functions,
                        fmi2False, fmi2False)) return 3;
    one = started(given[1], &functions);
    other = started(given[1], &functions);
    begun = clock();
    for (i = 0; i < steps; i++) {
        input[0] = -100 + 200. * (double)i / (double)steps;
        input[1] = 1e5 + 9e7 * (double)i / (double)steps;
        fmi2SetReal(one, inputs, 4, input);
        if (fmi2DoStep(one, 1e-3 * (double)i, 1e-3, fmi2True) != fmi2OK) return 4;
        fmi2GetReal(one, outputs, 5, output);
    }
    printf("%.3g us a step\n", 1e6 * (double)(clock() - begun) / CLOCKS_PER_SEC / (double)steps);
    fmi2GetFMUstate(one, &state);
    fmi2SerializedFMUstateSize(one, state, &size);
    if (size > sizeof bytes) return 5;
    fmi2SerializeFMUstate(one, state, bytes, size);
    fmi2DeSerializeFMUstate(other, bytes, size, &copy);
    fmi2SetFMUstate(other, copy);
    if (fmi2DoStep(other, -5, 1, fmi2True) != fmi2Error) return 6;
    fmi2FreeFMUstate(one, &state);
    fmi2FreeFMUstate(other, &copy);
    fmi2Terminate(one);
    fmi2Reset(one);
    fmi2FreeInstance(one);
    fmi2FreeInstance(other);
    return reported >= 6 ? 0 : 7;
}
