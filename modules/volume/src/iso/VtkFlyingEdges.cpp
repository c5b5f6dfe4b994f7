// SPDX-License-Identifier: GPL-3.0-or-later
// Marching cubes by W. Schroeder, R. Maynard, B. Geveci, Flying Edges (2015), as VTK has it.
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <type_traits>

#include "VtkIso.h"
#include "VtkThreads.h"

namespace vernier::iso {
namespace {

bool surfaceOf(const VtkBlock& block, double level, VtkIsoSurface& out) {
  vtkNew<vtkFloatArray> values;
  const vtkIdType count = static_cast<vtkIdType>(block.nx) * block.ny * block.nz;
  values->SetArray(const_cast<float*>(block.values), count, 1);  // kept by us, and only read
  vtkNew<vtkImageData> image;
  image->SetExtent(0, block.nx - 1, 0, block.ny - 1, block.firstLayer, block.firstLayer + block.nz - 1);
  image->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->ComputeNormalsOff();
  edges->ComputeGradientsOff();
  edges->ComputeScalarsOff();
  edges->InterpolateAttributesOff();
  edges->SetValue(0, level);
  edges->Update();
  vtkPolyData* const surface = edges->GetOutput();
  vtkPoints* const points = surface->GetPoints();
  out.xyz.clear(), out.corners.clear();
  if (!points || surface->GetNumberOfPolys() == 0) return true;
  const vtkIdType n = points->GetNumberOfPoints();
  if (n > 0xFFFFFFF0 || points->GetDataType() != VTK_FLOAT) return false;
  const float* const xyz = static_cast<const float*>(points->GetVoidPointer(0));
  out.xyz.assign(xyz, xyz + 3 * n);
  vtkCellArray* const cells = surface->GetPolys();
  out.corners.reserve(3 * static_cast<std::size_t>(cells->GetNumberOfCells()));
  vtkIdType corners = 0;
  const vtkIdType* corner = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(corners, corner);) {
    if (corners != 3) return false;
    for (vtkIdType i = 0; i < 3; ++i) out.corners.push_back(static_cast<std::uint32_t>(corner[i]));
  }
  return true;
}

}  // namespace
}  // namespace vernier::iso

extern "C" VERNIER_API bool vernier_vtk_iso_surface(const vernier::iso::VtkBlock& block, double level,
                                                    vernier::iso::VtkIsoSurface* out) {
  // Blocks are spread over threads by the caller.
  [[maybe_unused]] static const bool once =
      (vtkObject::GlobalWarningDisplayOff(), vernier::iso::oneThreadPerFilter(), true);
  return vernier::iso::surfaceOf(block, level, *out);
}
static_assert(std::is_same_v<decltype(vernier_vtk_iso_surface), vernier::iso::VtkIsoFn>);
