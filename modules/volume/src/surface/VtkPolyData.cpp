// SPDX-License-Identifier: GPL-3.0-or-later
#include "VtkPolyData.h"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <type_traits>

namespace vernier::surface {
namespace {

void keepFirstError(vtkObject*, unsigned long, void* kept, void* text) {
  std::string& error = *static_cast<std::string*>(kept);
  if (error.empty() && text) error = static_cast<const char*>(text);
}

// Appends all cells; false when one names a point that is not there.
bool append(vtkCellArray* cells, vtkIdType points, VtkPolyData& out, std::vector<std::uint64_t>& ends) {
  vtkIdType n = 0;
  const vtkIdType* corner = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(n, corner);) {
    for (vtkIdType i = 0; i < n; ++i) {
      if (corner[i] < 0 || corner[i] >= points) return false;
      out.corners.push_back(static_cast<std::uint32_t>(corner[i]));
    }
    ends.push_back(out.corners.size());
  }
  return true;
}

// VTK trusts the offsets of cells, so they are looked at before anything walks them.
bool sound(vtkCellArray* cells) {
  const vtkIdType n = cells->GetNumberOfCells(), corners = cells->GetNumberOfConnectivityIds();
  vtkIdType before = 0;
  for (vtkIdType i = 0; i <= n; ++i) {
    const vtkIdType at = n == 0 ? 0 : static_cast<vtkIdType>(cells->GetOffsetsArray()->GetComponent(i, 0));
    if (at < before || at > corners) return false;
    before = at;
  }
  return true;
}

VtkPolyData read(std::string_view bytes) {
  VtkPolyData out;
  vtkNew<vtkCallbackCommand> listener;
  listener->SetCallback(keepFirstError);
  listener->SetClientData(&out.error);
  vtkObject::GlobalWarningDisplayOff();  // VTK would print paths on stderr
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->AddObserver("ErrorEvent", listener);
  reader->AddObserver("WarningEvent", listener);
  reader->SetReaderErrorObserver(listener);
  reader->SetParserErrorObserver(listener);
  reader->ReadFromInputStringOn();
  reader->SetInputString(std::string(bytes));
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  if (!out.error.empty() || !data || !data->GetPoints()) {
    if (out.error.empty()) out.error = "no points";
    return out;
  }
  const vtkIdType n = data->GetNumberOfPoints();
  if (n > 0xFFFFFFF0 || !sound(data->GetPolys()) || !sound(data->GetStrips())) {
    out.error = "the offsets of cells do not ascend";
    return out;
  }
  out.xyz.resize(3 * static_cast<std::size_t>(n));
  for (vtkIdType i = 0; i < n; ++i) data->GetPoints()->GetPoint(i, out.xyz.data() + 3 * i);
  if (!append(data->GetPolys(), n, out, out.polygonEnds) || !append(data->GetStrips(), n, out, out.stripEnds))
    out.error = "a cell names a point that is not there";
  return out;
}

}  // namespace
}  // namespace vernier::surface

extern "C" VERNIER_API void vernier_vtk_read_vtp(const char* bytes, std::size_t count,
                                                 vernier::surface::VtkPolyData* out) {
  *out = vernier::surface::read({bytes, count});
}
static_assert(std::is_same_v<decltype(vernier_vtk_read_vtp), vernier::surface::VtkReadFn>);
