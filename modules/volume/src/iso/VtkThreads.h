// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace vernier::iso {
// VTK's filters then use no threads of their own.
void oneThreadPerFilter();
}  // namespace vernier::iso
