// SPDX-License-Identifier: GPL-3.0-or-later
// Linked into programs of sanitized builds that open a window: no library is unloaded. GL drivers keep some
// blocks for ever, and a leak of a library that is gone is reported as one of an "<unknown module>":
// tests/support/lsan.supp could not tell it from a leak of ours. This way leaks are looked for in the window
// as well.
#include <dlfcn.h>

extern "C" __attribute__((visibility("default"))) int dlclose(void*) noexcept { return 0; }
