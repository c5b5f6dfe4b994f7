// SPDX-License-Identifier: GPL-3.0-or-later
// C++17: vtkSMPTools.h of VTK 9.1 does not compile as C++20.
#include "VtkThreads.h"

#include <vtkSMPTools.h>

namespace vernier::iso {
void oneThreadPerFilter() { vtkSMPTools::SetBackend("Sequential"); }
}  // namespace vernier::iso
