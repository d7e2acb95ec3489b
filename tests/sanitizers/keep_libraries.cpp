// Linked into every program of a sanitizer's build. A library that is unloaded takes with it the
// only pointers to what it keeps until the end: LeakSanitizer would call that lost, and name
// <unknown module>, for which there is no suppression. Mesa's drivers are unloaded with each
// display that is closed.
extern "C" int dlclose(void*) noexcept { return 0; }
