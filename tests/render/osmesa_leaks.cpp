// OSMesaDestroyContext() of Mesa 22 forgets the few hundred bytes that describe the context's
// buffer. LeakSanitizer shall go on finding our own leaks, not this one.

#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libOSMesa.so\n";
}
#endif
