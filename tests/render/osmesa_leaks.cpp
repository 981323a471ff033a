// OSMesaDestroyContext() of Mesa 22 forgets the few hundred bytes that describe the context's
// buffer. LeakSanitizer shall go on finding our own leaks, not this one.

#include "tests/address_sanitizer.h"

#if CLOTH_ADDRESS_SANITIZER
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libOSMesa.so\n";
}
#endif
