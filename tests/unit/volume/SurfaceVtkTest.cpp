// SPDX-License-Identifier: GPL-3.0-or-later
// Our readers against VTK: files that VTK's writers made, and real files through VTK's own readers.
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkOBJWriter.h>
#include <vtkPLYWriter.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSTLWriter.h>
#include <vtkSphereSource.h>
#include <vtkStripper.h>
#include <vtkXMLPolyDataWriter.h>

#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include "TestData.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier::test {
namespace {

using Corner = std::array<double, 3>;
using Corners = std::multiset<std::array<Corner, 3>>;

// A triangle begins with its lowest corner; the sense of turning stays.
std::array<Corner, 3> turned(std::array<Corner, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

Corners cornersOf(const Mesh& mesh) {
  Corners all;
  for (const Triangle& t : mesh.triangles()) {
    std::array<Corner, 3> c;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 p = mesh.vertices()[t[i]].p;
      c[i] = {p.x, p.y, p.z};
    }
    all.insert(turned(c));
  }
  return all;
}

Corners cornersOf(vtkPolyData* data) {
  Corners all;
  vtkIdType n = 0;
  const vtkIdType* id = nullptr;
  for (data->GetPolys()->InitTraversal(); data->GetPolys()->GetNextCell(n, id);) {
    std::array<Corner, 3> c;
    for (std::size_t i = 0; i < 3; ++i) data->GetPoint(id[i], c[i].data());
    all.insert(turned(c));
  }
  return all;
}

class SurfaceVtk : public ::testing::Test {
 protected:
  void SetUp() override {
    sphere_->SetRadius(10);
    sphere_->SetCenter(1, 2, 3);
    sphere_->SetThetaResolution(24);
    sphere_->SetPhiResolution(16);
    sphere_->Update();
  }
  std::string path(const std::string& name) const { return (dir_.path() / name).string(); }
  template <class Writer>
  void write(Writer* writer, vtkPolyData* data, const std::string& name) {
    writer->SetFileName(path(name).c_str());
    writer->SetInputData(data);
    ASSERT_EQ(writer->Write(), 1);
  }
  void expectSphere(const std::string& name, bool exactly) {
    SCOPED_TRACE(name);
    const Result<SurfaceFile> file = readSurface(path(name));
    ASSERT_TRUE(file.ok()) << file.error().text();
    if (exactly) {
      EXPECT_EQ(cornersOf(*file->mesh), cornersOf(sphere_->GetOutput()));
    }
    const MeshFacts f = meshFacts(*file->mesh);
    EXPECT_EQ(file->triangles, static_cast<std::uint64_t>(sphere_->GetOutput()->GetNumberOfCells()));
    EXPECT_TRUE(f.closed);
    EXPECT_GT(f.signedVolume_mm3, 0.9 * 4.0 / 3 * std::numbers::pi * 1000);
  }
  vtkNew<vtkSphereSource> sphere_;
  TempDir dir_;
};

TEST_F(SurfaceVtk, WhatVtkWritesIsReadCornerByCorner) {
  for (const bool binary : {true, false}) {
    vtkNew<vtkSTLWriter> stl;
    binary ? stl->SetFileTypeToBinary() : stl->SetFileTypeToASCII();
    write(stl.Get(), sphere_->GetOutput(), binary ? "binary.stl" : "text.stl");
    vtkNew<vtkPLYWriter> ply;
    binary ? ply->SetFileTypeToBinary() : ply->SetFileTypeToASCII();
    write(ply.Get(), sphere_->GetOutput(), binary ? "binary.ply" : "text.ply");
  }
  vtkNew<vtkOBJWriter> obj;
  write(obj.Get(), sphere_->GetOutput(), "a.obj");
  expectSphere("binary.stl", true);
  expectSphere("binary.ply", true);
  for (const char* text : {"text.stl", "text.ply", "a.obj"})
    expectSphere(text, false);  // digits are lost in text
}

TEST_F(SurfaceVtk, VtpInEveryEncodingAndCompression) {
  int n = 0;
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended})
    for (const int compressor :
         {vtkXMLWriter::NONE, vtkXMLWriter::ZLIB, vtkXMLWriter::LZ4, vtkXMLWriter::LZMA}) {
      vtkNew<vtkXMLPolyDataWriter> writer;
      writer->SetDataMode(mode);
      writer->SetCompressorType(compressor);
      const std::string name = "v" + std::to_string(n++) + ".vtp";
      write(writer.Get(), sphere_->GetOutput(), name);
      expectSphere(name, mode != vtkXMLWriter::Ascii);
    }
}

TEST_F(SurfaceVtk, VtpStripsTurnTheRightWay) {
  vtkNew<vtkStripper> strips;
  strips->SetInputData(sphere_->GetOutput());
  strips->Update();
  ASSERT_GT(strips->GetOutput()->GetNumberOfStrips(), 0);
  vtkNew<vtkXMLPolyDataWriter> writer;
  write(writer.Get(), strips->GetOutput(), "strips.vtp");
  expectSphere("strips.vtp", true);
}

TEST_F(SurfaceVtk, CutAndChangedVtpNeverCrashes) {
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
    sphere_->SetThetaResolution(4);
    sphere_->SetPhiResolution(4);
    sphere_->Update();
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetDataMode(mode);
    write(writer.Get(), sphere_->GetOutput(), "a.vtp");
    std::ifstream in(path("a.vtp"), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    ::testing::internal::CaptureStderr();
    for (std::size_t n = 0; n < bytes.size(); n += 5) {
      std::string changed = bytes;
      changed[n] = static_cast<char>(changed[n] ^ (1 << (n % 7)));
      for (const std::string& text : {bytes.substr(0, n), changed}) {
        std::ofstream(path("b.vtp"), std::ios::binary) << text;
        const auto file = readSurface(path("b.vtp"));
        if (!file.ok()) {
          EXPECT_FALSE(file.error().sentence.empty());
        }
      }
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // VTK would print paths
  }
}

TEST_F(SurfaceVtk, VtpThatDeclaresMoreThanItHolds) {
  vtkNew<vtkXMLPolyDataWriter> writer;
  write(writer.Get(), sphere_->GetOutput(), "a.vtp");
  std::ifstream in(path("a.vtp"), std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const std::size_t at = bytes.find("NumberOfPoints=\"") + 16;
  bytes.insert(at, "99999999");
  std::ofstream(path("b.vtp"), std::ios::binary) << bytes;
  const auto file = readSurface(path("b.vtp"));
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, ErrorCode::FileDamaged);
  EXPECT_NE(file.error().sentence.find("NumberOfPoints"), std::string::npos);
}

TEST_F(SurfaceVtk, TheRealScrewIsTheSameThroughVtksReader) {
  VERNIER_NEEDS_DATA("surf_pedicle_screw");
  const std::string screw = (dataDir() / "surf_pedicle_screw" / "D4.5L30.stl").string();
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName(screw.c_str());
  reader->Update();
  const Result<SurfaceFile> file = readSurface(screw);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(cornersOf(*file->mesh), cornersOf(reader->GetOutput()));
  EXPECT_EQ(static_cast<vtkIdType>(file->mesh->vertices().size()), reader->GetOutput()->GetNumberOfPoints());
}

}  // namespace
}  // namespace vernier::test
