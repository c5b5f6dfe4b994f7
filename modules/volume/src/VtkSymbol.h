// SPDX-License-Identifier: GPL-3.0-or-later
// vernier_vtk.so, the only library of Vernier that is linked with VTK: Debian's VTK brings OpenGL and X11
// along, and most pictures need neither. Loaded when the first of its functions is asked for, never closed:
// VTK keeps objects of its own until the program ends.
#pragma once

namespace vernier {

inline constexpr const char* kVtkLibrary = "vernier_vtk.so";
// nullptr where VTK's libraries are not installed. Thread-safe.
void* vtkSymbol(const char* name);

}  // namespace vernier
