/* What a co-simulation FMU needs of FMI 2.0.4 (fmi-standard.org): its types and functions.
   Declared here so that these sources compile without any other file. */
#ifndef CAMRING_FMI2_H
#define CAMRING_FMI2_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

enum { fmi2False, fmi2True };
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated }
    fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined(_WIN32) || defined(__CYGWIN__)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

/* Functions of several FMUs in one program are distinguished by a prefix. */
#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_PASTE_(a, b) a##b
#define FMI2_PASTE(a, b) FMI2_PASTE_(a, b)
#define FMI2_NAME(name) FMI2_PASTE(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2_NAME(name) name
#endif
#define FMI2_STATUS(name) FMI2_EXPORT fmi2Status FMI2_NAME(name)

FMI2_EXPORT const char *FMI2_NAME(fmi2GetTypesPlatform)(void);
FMI2_EXPORT const char *FMI2_NAME(fmi2GetVersion)(void);
FMI2_EXPORT fmi2Component FMI2_NAME(fmi2Instantiate)(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging);
FMI2_EXPORT void FMI2_NAME(fmi2FreeInstance)(fmi2Component c);

FMI2_STATUS(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                 const fmi2String categories[]);
FMI2_STATUS(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined,
                                 fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                                 fmi2Real stop);
FMI2_STATUS(fmi2EnterInitializationMode)(fmi2Component c);
FMI2_STATUS(fmi2ExitInitializationMode)(fmi2Component c);
FMI2_STATUS(fmi2Terminate)(fmi2Component c);
FMI2_STATUS(fmi2Reset)(fmi2Component c);

FMI2_STATUS(fmi2GetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                         fmi2Real value[]);
FMI2_STATUS(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            fmi2Integer value[]);
FMI2_STATUS(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            fmi2Boolean value[]);
FMI2_STATUS(fmi2GetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                           fmi2String value[]);
FMI2_STATUS(fmi2SetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                         const fmi2Real value[]);
FMI2_STATUS(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            const fmi2Integer value[]);
FMI2_STATUS(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                            const fmi2Boolean value[]);
FMI2_STATUS(fmi2SetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                           const fmi2String value[]);

FMI2_STATUS(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state);
FMI2_STATUS(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state);
FMI2_STATUS(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state);
FMI2_STATUS(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size);
FMI2_STATUS(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                   size_t size);
FMI2_STATUS(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                     fmi2FMUstate *state);
FMI2_STATUS(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[],
                                          size_t unknowns, const fmi2ValueReference known[],
                                          size_t knowns, const fmi2Real seed[],
                                          fmi2Real derivative[]);

FMI2_STATUS(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                         size_t count, const fmi2Integer order[],
                                         const fmi2Real value[]);
FMI2_STATUS(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                          size_t count, const fmi2Integer order[],
                                          fmi2Real value[]);
FMI2_STATUS(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_way_back);
FMI2_STATUS(fmi2CancelStep)(fmi2Component c);
FMI2_STATUS(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value);
FMI2_STATUS(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value);
FMI2_STATUS(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind,
                                  fmi2Integer *value);
FMI2_STATUS(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind,
                                  fmi2Boolean *value);
FMI2_STATUS(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value);

#endif
