// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP archives, honest ones and others: what is refused carries a sentence, the rest loads.
#include "vernier/study/Archive.h"

#include <gmock/gmock.h>

#include "MakeDicom.h"
#include "MakeZip.h"
#include "TestData.h"
#include "vernier/study/Files.h"
#include "vernier/study/Limits.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {
using test::ZipEntry;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string bytesOf(const fs::path& p) {
  std::ifstream f(p, std::ios::binary);
  return {std::istreambuf_iterator<char>(f), {}};
}

class ArchiveTest : public ::testing::Test {
 protected:
  std::string zip(const std::vector<ZipEntry>& entries) {
    test::writeZip(dir_.path() / "a.zip", entries);
    return (dir_.path() / "a.zip").string();
  }
  Result<std::shared_ptr<const Archive>> open(const std::vector<ZipEntry>& entries) {
    const auto record = recordOf(zip(entries));
    return Archive::open(*openInput(*record), record->shown);
  }
  std::vector<ZipEntry> study(int slices = 5) {
    test::DicomSlice first;
    first.pixels = {1, 2, 3, 4, 5};
    test::writeSeries(dir_.path() / "study", slices, {0, 0, 2}, first);
    std::vector<ZipEntry> entries;
    for (int k = 0; k < slices; ++k) {
      const std::string name = "00" + std::to_string(k) + ".dcm";
      entries.push_back({"folder/" + name, bytesOf(dir_.path() / "study" / name), k % 2 == 0});
    }
    return entries;
  }
  test::TempDir dir_;
};

TEST_F(ArchiveTest, AStudyInsideIsTheStudyOutside) {
  const auto inside = scanStudy({zip(study())});
  const auto outside = scanStudy({(dir_.path() / "study").string()});
  ASSERT_TRUE(inside.ok()) << inside.error().text();
  ASSERT_TRUE(outside.ok());
  ASSERT_EQ(inside->instances.size(), 5u);
  ASSERT_EQ(inside->series.size(), 1u);
  EXPECT_EQ(inside->series[0].stacks[0].positions_mm, outside->series[0].stacks[0].positions_mm);
  const Stack& stack = inside->series[0].stacks[0];
  std::vector<std::byte> a(5 * 32), b(5 * 32);
  std::vector<SliceFailure> failed;
  ASSERT_TRUE(decodeStack(*inside, stack, SampleType::I16, a, failed).ok());
  EXPECT_TRUE(failed.empty());
  ASSERT_TRUE(decodeStack(*outside, outside->series[0].stacks[0], SampleType::I16, b, failed).ok());
  EXPECT_EQ(a, b);
  for (const FileRecord& f : inside->files)
    EXPECT_EQ(f.shown.find('/'), std::string::npos) << "last part only";
}

TEST_F(ArchiveTest, WhatIsRefusedSaysWhyAndTheRestLoads) {
  auto entries = study();
  const std::string bytes = entries[0].bytes;
  const std::string inner = test::zipBytes({{"x", "y"}});
  const std::vector<std::pair<ZipEntry, const char*>> hostile = {
      {{"../up.dcm", bytes}, "outside"},
      {{"a/../../up.dcm", bytes}, "outside"},
      {{"/etc/absolute.dcm", bytes}, "outside"},
      {{"C:\\absolute.dcm", bytes}, "outside"},
      {{"\\\\server\\share.dcm", bytes}, "outside"},
      {{"..\\up.dcm", bytes}, "outside"},
      {{"link.dcm", "/etc/passwd", false, 0120777}, "symbolic link"},
      {{"pipe", "", false, 0010644}, "device, pipe"},
      {{"secret.dcm", bytes, false, 0100644, true}, "encrypted"},
      {{"nested.zip", inner, false}, "inside an archive"},
      {{"bomb", std::string(80 << 20, '\0')}, "grows more than"},
      {{"long.dcm", bytes, true, 0100644, false, static_cast<std::uint32_t>(bytes.size() - 10)}, "damaged"},
      {{"short.dcm", bytes, true, 0100644, false, static_cast<std::uint32_t>(bytes.size() + 10)}, "damaged"},
  };
  for (const auto& [entry, sentence] : hostile) entries.push_back(entry);
  const auto set = scanStudy({zip(entries)});
  ASSERT_TRUE(set.ok()) << set.error().text();
  EXPECT_EQ(set->instances.size() >= 5u, true);
  ASSERT_EQ(set->files.size(), entries.size());
  for (std::size_t n = 0; n < hostile.size(); ++n) {
    const FileRecord& f = set->files[5 + n];
    SCOPED_TRACE(f.shown);
    EXPECT_EQ(f.shown.find('/'), std::string::npos);
    if (hostile[n].second == std::string("damaged")) continue;  // found when the end of the entry is read
    ASSERT_TRUE(f.error);
    EXPECT_THAT(f.error->sentence, HasSubstr(hostile[n].second));
    EXPECT_EQ(f.error->where, f.shown);
  }
  EXPECT_EQ(set->series[0].stacks[0].slices.size() >= 5u, true);
}

TEST_F(ArchiveTest, SizeAndChecksumAreThoseOfTheBytes) {
  const std::string text(3'000'000, 'a');
  const auto whole = [&](const ZipEntry& e) {
    const auto archive = open({e});
    EXPECT_TRUE(archive.ok());
    return (*archive)->whole(0);
  };
  const auto good = whole({"a", text});
  ASSERT_TRUE(good.ok());
  EXPECT_EQ((*good)->size(), text.size());
  EXPECT_TRUE(whole({"a", ""}).ok());
  EXPECT_TRUE(whole({"a", "stored", false}).ok());
  for (const bool deflate : {true, false}) {
    ZipEntry e{"a", text, deflate};
    e.saysCrc = 17;
    EXPECT_EQ(whole(e).error().code, ErrorCode::FileDamaged);
    e.saysCrc.reset();
    for (const std::uint32_t n : {1u, 2'999'999u, 3'000'001u, 60'000'000u}) {
      e.saysBytes = n;
      EXPECT_EQ(whole(e).error().code, ErrorCode::FileDamaged) << n;
    }
  }
}

// The entries of a study that share one packed piece: each is small and honest, all together are a bomb.
TEST_F(ArchiveTest, EntriesThatOverlapAreNotUnpackedBeyondTheArchive) {
  std::vector<ZipEntry> entries{{"a", std::string(1 << 20, 'x')}};
  for (int i = 0; i < 2000; ++i) {
    entries.push_back({"b" + std::to_string(i), ""});
    entries.back().sharesDataOf = 0;
  }
  const auto archive = open(entries);
  ASSERT_TRUE(archive.ok()) << archive.error().text();
  std::uint64_t readable = 0, refused = 0;
  for (const Archive::Entry& e : (*archive)->entries()) (e.error ? refused : readable) += e.bytes;
  EXPECT_LE(readable, limits::kArchiveAlwaysBytes);
  EXPECT_GT(refused, readable);
}

TEST_F(ArchiveTest, DamagedArchivesSaySo) {
  const std::string whole = test::zipBytes(study());
  const auto write = [&](const std::string& bytes) {
    std::ofstream(dir_.path() / "a.zip", std::ios::binary) << bytes;
    return (dir_.path() / "a.zip").string();
  };
  for (std::size_t n = 4; n < whole.size(); n += whole.size() / 60) {
    const auto set = scanStudy({write(whole.substr(0, n))});
    ASSERT_TRUE(set.ok());
    ASSERT_EQ(set->files.size(), 1u);
    ASSERT_TRUE(set->files[0].error);
    EXPECT_EQ(set->files[0].error->code, ErrorCode::FileDamaged);
    EXPECT_EQ(set->files[0].error->where, "a.zip");
  }
  for (std::size_t at = 0; at < whole.size(); at += 3) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x5a);
    const auto set = scanStudy({write(flipped)});
    ASSERT_TRUE(set.ok());
    for (std::size_t i = 0; i < set->instances.size(); ++i) {
      const auto bytes = set->instances[i].pixels.frameBytes();
      if (!bytes || *bytes > 1 << 20) continue;
      std::vector<std::byte> out(*bytes);
      (void)decodeSlice(*set, {i, 0}, out);
    }
  }
}

TEST_F(ArchiveTest, AnArchiveInAFolderIsLeftPacked) {
  fs::create_directory(dir_.path() / "in");
  test::writeZip(dir_.path() / "in/a.zip", study());
  const auto set = scanStudy({(dir_.path() / "in").string()});
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->files.size(), 1u);
  ASSERT_TRUE(set->files[0].error);
  EXPECT_THAT(set->files[0].error->sentence, HasSubstr("by itself"));
}

TEST_F(ArchiveTest, ManyReadersAtATime) {
  std::vector<ZipEntry> entries;
  for (int i = 0; i < 20; ++i)
    entries.push_back({std::to_string(i), std::string(200'000, static_cast<char>('a' + i))});
  const auto archive = open(entries);
  ASSERT_TRUE(archive.ok());
  std::vector<std::unique_ptr<Archive::Reader>> readers;
  for (std::size_t i = 0; i < 20; ++i) readers.push_back(std::move(*(*archive)->reader(i)));
  for (int piece = 0; piece < 2; ++piece)
    for (std::size_t i = 0; i < 20; ++i) {
      std::vector<std::byte> out(100'000);
      const auto n = readers[i]->read(out);
      ASSERT_TRUE(n.ok());
      EXPECT_EQ(out, std::vector<std::byte>(100'000, static_cast<std::byte>('a' + i)));
    }
}

TEST_F(ArchiveTest, TheEmptyArchiveHoldsNothing) {
  const auto set = scanStudy({zip({})});
  ASSERT_TRUE(set.ok());
  EXPECT_TRUE(set->files.empty());
}

}  // namespace
}  // namespace vernier
