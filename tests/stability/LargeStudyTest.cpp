// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases A14, A15 and A20: far from the origin, larger than 32 bits can count, and bombs.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>

#include "MakeDicom.h"
#include "TestData.h"
#include "vernier/study/Limits.h"
#include "vernier/study/Load.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;
using test::DicomSlice;
using test::EnhancedObject;
using test::TempDir;

StudySet scan(const fs::path& p) {
  auto set = scanStudy({p.string()});
  EXPECT_TRUE(set) << (set ? "" : set.error().text());
  return set ? std::move(*set) : StudySet();
}
long peakRss_kB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}
std::uint64_t available_kB() {
  std::ifstream in("/proc/meminfo");
  std::string word;
  std::uint64_t value = 0;
  while (in >> word)
    if (word == "MemAvailable:" && in >> value) return value;
  return 0;
}

// --- A14 ---

// The same stack at the origin and 1000 m away from it: each voxel lies exactly that far from its twin, the
// shape, the step and every value are the same.
void expectSameFarAway(const std::function<void(const fs::path&, double)>& write) {
  const TempDir here, far;
  write(here.path(), 0);
  write(far.path(), 1e6);
  const StudySet a = scan(here.path()), b = scan(far.path());
  const Stack &s = a.series.at(0).stacks.at(0), &t = b.series.at(0).stacks.at(0);
  ASSERT_EQ(s.shape, StackShape::Uniform);
  ASSERT_EQ(t.shape, StackShape::Uniform);
  EXPECT_EQ(s.findings.size(), t.findings.size());
  EXPECT_NEAR(s.step_mm, t.step_mm, 1e-9);
  for (const glm::dvec3 v : {glm::dvec3(0), glm::dvec3(3, 3, 4), glm::dvec3(0, 3, 2)}) {
    const glm::dvec3 p = (s.grid.patientFromVoxel * VoxelPoint(v)).p,
                     q = (t.grid.patientFromVoxel * VoxelPoint(v)).p;
    EXPECT_LE(glm::length(q - p - glm::dvec3(1e6, -1e6, 1e6)), 1e-6)
        << "a hundredth of a millimetre is the limit";
  }
  const auto u = buildVolume(a, a.series[0], s), w = buildVolume(b, b.series[0], t);
  ASSERT_TRUE(u && w);
  for (double x = 0.25; x < 3; x += 0.5) {
    const PatientPoint p = s.grid.patientFromVoxel * VoxelPoint(glm::dvec3(x, 1.3, 2.6));
    const PatientPoint q(p.p + glm::dvec3(1e6, -1e6, 1e6));
    EXPECT_NEAR(*sampleModality(**u, p), *sampleModality(**w, q), 1e-6);
  }
}

TEST(Stability, A14_OriginAThousandMetresAway) {
  expectSameFarAway([](const fs::path& dir, double shift) {
    DicomSlice d;
    d.position = {0.1 + shift, 0.2 - shift, 0.3 + shift};
    test::writeSeries(dir, 5, {0, 0, 0.7}, d);
  });
}

TEST(Stability, A14_FramesAThousandMetresAway) {
  expectSameFarAway([](const fs::path& dir, double shift) {
    EnhancedObject o = test::enhancedStack({0, 0, 0, 0, 0});
    for (std::size_t f = 0; f < 5; ++f) {
      char text[80];
      std::snprintf(text, sizeof text, "%.1f\\%.1f\\%.1f", 0.1 + shift, 0.2 - shift,
                    0.3 + 0.7 * static_cast<double>(f) + shift);
      o.perFrame[f][0].set[0].second = text;
    }
    test::writeEnhanced(dir / "far.dcm", o);
  });
}

// --- A15 ---

// An Enhanced CT of 2048 x 2048 x 520 voxels of one byte, 2^31 and some: zeros that take no room on the disk,
// but for the very last voxel.
fs::path writeHuge(const fs::path& dir) {
  constexpr std::uint32_t kFrames = 520, kSide = 2048;
  std::vector<double> z(kFrames);
  for (std::size_t f = 0; f < kFrames; ++f) z[f] = static_cast<double>(f);
  EnhancedObject o = test::enhancedStack(z);
  o.rows = o.columns = 1;
  o.pixels.clear();
  o.bitsAllocated = o.bitsStored = 8;
  o.isSigned = false;
  o.set.push_back({"0028,0010", std::to_string(kSide)});
  o.set.push_back({"0028,0011", std::to_string(kSide)});
  o.erase.push_back("7FE0,0010");
  const fs::path file = dir / "huge.dcm";
  test::writeEnhanced(file, o);
  std::string head("\xE0\x7F\x10\x00OW\0\0", 8);
  const std::uint32_t length = kFrames * kSide * kSide;
  for (int b = 0; b < 4; ++b) head += static_cast<char>(length >> (8 * b));
  std::ofstream(file, std::ios::binary | std::ios::app) << head;
  const auto begin = fs::file_size(file);
  fs::resize_file(file, begin + length);
  std::fstream last(file, std::ios::binary | std::ios::in | std::ios::out);
  last.seekp(static_cast<std::streamoff>(begin + length - 1));
  last.put(77);
  return file;
}

TEST(Stability, A15_MoreThanTwoToThe31VoxelsAreRefusedBeforeAllocation) {
  const TempDir dir;
  writeHuge(dir.path());
  const long before_kB = peakRss_kB();
  const StudySet set = scan(dir.path());
  const Stack& stack = set.series.at(0).stacks.at(0);
  ASSERT_TRUE(stack.volume3d);
  MemoryBudget budget(std::uint64_t{1} << 30);
  BuildOptions options;
  options.budget = &budget;
  const auto volume = buildVolume(set, set.series[0], stack, options);
  ASSERT_FALSE(volume);
  EXPECT_EQ(volume.error().code, ErrorCode::OutOfMemory);
  EXPECT_NE(volume.error().sentence.find("MB"), std::string::npos) << volume.error().sentence;
  EXPECT_EQ(budget.used(), 0u);
  EXPECT_LT(peakRss_kB() - before_kB, 64 << 10);
  // A single frame of it can be seen all the same.
  EXPECT_TRUE(buildImageFrame(set, set.series[0], stack, 519, VoiWindow{0, 1, VoiFunction::Linear, ""}));
}

TEST(Stability, A15_MoreThanTwoToThe31VoxelsLoadWhereThereIsMemory) {
  if (available_kB() < 6u << 20) {
    std::cout << "[  NOTE    ] less than 6 GiB of memory are free: loading 2^31 voxels is not checked\n";
    return;
  }
  const TempDir dir;
  writeHuge(dir.path());
  const StudySet set = scan(dir.path());
  const auto volume = buildVolume(set, set.series.at(0), set.series[0].stacks.at(0));
  ASSERT_TRUE(volume) << volume.error().text();
  EXPECT_GT((*volume)->bytes(), std::size_t{1} << 31);
  EXPECT_EQ((*volume)->stored(2047, 2047, 519), 77);
  EXPECT_EQ((*volume)->stored(2046, 2047, 519), 0);
  EXPECT_EQ((*volume)->modalityRange()->max, 77);
}

TEST(Stability, A15_SizesThatOverflowAreRefused) {
  const TempDir dir;
  DicomSlice d;
  d.set = {{"0028,0008", "100000"}, {"0028,0010", "65535"}, {"0028,0011", "65535"}, {"0028,0100", "32"}};
  test::writeDicom(dir.path() / "a.dcm", d);
  const long before_kB = peakRss_kB();
  const StudySet set = scan(dir.path());
  ASSERT_TRUE(set.instances.at(0).pixelError);
  EXPECT_LT(peakRss_kB() - before_kB, 64 << 10);
}

// --- A20 ---

std::string deflated(const std::string& plain) {
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&z, plain.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  z.avail_in = static_cast<uInt>(plain.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

// The data set of a file in explicit little endian, deflated with `more` behind it.
void deflateFile(const fs::path& file, const std::string& more) {
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  // The meta header: its group length stands in the first element behind the preamble.
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 140, 4);
  const std::size_t end = 144 + length;
  std::string meta = bytes.substr(0, end);
  const std::size_t syntax = meta.find("1.2.840.10008.1.2.1");
  meta.replace(syntax - 2, 2, std::string("\x16\0", 2));
  meta.insert(syntax + 19, ".99");  // 19 + NUL pad become 22
  meta.erase(syntax + 22, 1);
  std::uint32_t grown = length + 2;
  std::memcpy(meta.data() + 140, &grown, 4);
  std::ofstream(file, std::ios::binary) << meta << deflated(bytes.substr(end) + more);
}

std::string element(std::uint16_t group, std::uint16_t number, const char* vr, const std::string& value) {
  std::string out;
  const auto add = [&](std::uint32_t v, int n) {
    for (int b = 0; b < n; ++b) out += static_cast<char>(v >> (8 * b));
  };
  add(group, 2);
  add(number, 2);
  out += vr;
  out += std::string(2, '\0');
  add(static_cast<std::uint32_t>(value.size()), 4);
  return out + value;
}

// 300 MB of zeros in 300 kB. Behind the pixel description, as something that nobody asked for.
TEST(Stability, A20_ABombInTheHeaderIsRefused) {
  const TempDir dir;
  DicomSlice d;
  d.erase = {"7FE0,0010"};
  test::writeDicom(dir.path() / "bomb.dcm", d);
  std::string parts;
  for (int n = 0; n < 5; ++n)
    parts += element(0x0041, static_cast<std::uint16_t>(0x1000 + n), "OB", std::string(60 << 20, '\0'));
  deflateFile(dir.path() / "bomb.dcm", parts);
  ASSERT_LT(fs::file_size(dir.path() / "bomb.dcm"), 400u << 10);
  parts = std::string();
  const long before_kB = peakRss_kB();
  const StudySet set = scan(dir.path());
  ASSERT_TRUE(set.files.at(0).error);
  EXPECT_EQ(set.files[0].error->code, ErrorCode::LimitExceeded);
  EXPECT_LT(peakRss_kB() - before_kB, 160 << 10);
}

TEST(Stability, A20_ABombOfPixelsIsRefusedWhileScanning) {
  const TempDir dir;
  DicomSlice d;
  d.erase = {"7FE0,0010"};
  d.set = {{"0028,0008", "300"}, {"0028,0010", "1024"}, {"0028,0011", "512"}};
  test::writeDicom(dir.path() / "bomb.dcm", d);
  deflateFile(dir.path() / "bomb.dcm", element(0x7FE0, 0x0010, "OW", std::string(300 << 20, '\0')));
  const long before_kB = peakRss_kB();
  const StudySet set = scan(dir.path());
  const Instance& i = set.instances.at(0);
  ASSERT_TRUE(i.pixelError);
  EXPECT_TRUE(set.series.at(0).stacks.empty());
  EXPECT_LT(peakRss_kB() - before_kB, 160 << 10);
  // And where a caller asks for the frames all the same.
  StudySet forced = set;
  forced.instances[0].pixelError.reset();
  forced.instances[0].isImage = true;
  std::vector<std::byte> frame(1024 * 512 * 2);
  FrameReader reader(forced);
  Result<void> last;
  std::uint64_t f = 0;
  for (; f < 300 && last; ++f) last = reader.read({0, f}, frame);
  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().code, ErrorCode::LimitExceeded);
  EXPECT_LT(f, 100u);
  EXPECT_LT(peakRss_kB() - before_kB, 160 << 10);
}

// An honest mask that is nearly empty packs denser than any image and is read.
TEST(Stability, A20_AnHonestBlankImageIsRead) {
  const TempDir dir;
  DicomSlice d;
  d.frames = 1;
  d.rows = d.columns = 2000;
  d.transferSyntaxUid = "1.2.840.10008.1.2.1.99";
  test::writeDicom(dir.path() / "blank.dcm", d);
  ASSERT_LT(fs::file_size(dir.path() / "blank.dcm") * limits::kMaxInflateRatio, 8'000'000u);
  const StudySet set = scan(dir.path());
  EXPECT_FALSE(set.instances.at(0).pixelError);
  std::vector<std::byte> frame(2000 * 2000 * 2, std::byte{1});
  ASSERT_TRUE(decodeSlice(set, {0, 0}, frame));
  EXPECT_EQ(frame.back(), std::byte{0});
}

}  // namespace
}  // namespace vernier
