// SPDX-License-Identifier: GPL-3.0-or-later
// libzip reads through our own source, so that all its handles share one open file; a handle is for one
// thread at a time, so each reader takes one of its own from a pool.
#include "vernier/study/Archive.h"

#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>

#include "ArchiveRules.h"
#include "vernier/study/Files.h"

namespace vernier {

// Entries that somebody holds whole. Each has its own lock, so that different ones are unpacked at a time.
struct Archive::Shared {
  struct Slot {
    std::mutex mutex;
    std::weak_ptr<const std::vector<std::byte>> bytes;
  };
  std::mutex mutex;
  std::map<std::size_t, Slot> slots;
  Slot& of(std::size_t entry) {
    const std::lock_guard lock(mutex);
    return slots[entry];
  }
};

Archive::Archive() : shared_(std::make_unique<Shared>()) {}
Archive::~Archive() = default;

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;

Error damagedEntry(const std::string& name) {
  return makeError(ErrorCode::FileDamaged,
                   "The entry of the archive is damaged or not as long as it says; fetch the archive again.",
                   name);
}

// What libzip asks of a file, for reading only.
struct FileForZip {
  std::shared_ptr<const InputFile> file;
  std::uint64_t at = 0;
  zip_error_t error;
};

zip_int64_t answer(void* user, void* data, zip_uint64_t length, zip_source_cmd_t command) {
  FileForZip& f = *static_cast<FileForZip*>(user);
  switch (command) {
    case ZIP_SOURCE_OPEN:
      f.at = 0;
      return 0;
    case ZIP_SOURCE_CLOSE:
      return 0;
    case ZIP_SOURCE_READ: {
      const std::uint64_t left = f.file->size() - std::min(f.at, f.file->size());
      const std::uint64_t n = std::min<std::uint64_t>(left, length);
      if (!f.file->read(f.at, {static_cast<std::byte*>(data), static_cast<std::size_t>(n)})) {
        zip_error_set(&f.error, ZIP_ER_READ, 0);
        return -1;
      }
      f.at += n;
      return static_cast<zip_int64_t>(n);
    }
    case ZIP_SOURCE_SEEK: {
      const zip_int64_t to = zip_source_seek_compute_offset(f.at, f.file->size(), data, length, &f.error);
      if (to < 0) return -1;
      f.at = static_cast<std::uint64_t>(to);
      return 0;
    }
    case ZIP_SOURCE_TELL:
      return static_cast<zip_int64_t>(f.at);
    case ZIP_SOURCE_STAT: {
      zip_stat_t* s = static_cast<zip_stat_t*>(data);
      zip_stat_init(s);
      s->valid = ZIP_STAT_SIZE;
      s->size = f.file->size();
      return sizeof *s;
    }
    case ZIP_SOURCE_ERROR:
      return zip_error_to_data(&f.error, data, length);
    case ZIP_SOURCE_FREE:
      delete &f;
      return 0;
    case ZIP_SOURCE_SUPPORTS:
      return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                            ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE,
                                            ZIP_SOURCE_SEEK, ZIP_SOURCE_TELL, ZIP_SOURCE_SUPPORTS, -1);
    default:
      zip_error_set(&f.error, ZIP_ER_OPNOTSUPP, 0);
      return -1;
  }
}

struct Discard {
  void operator()(zip_t* z) const { zip_discard(z); }
  void operator()(zip_file_t* f) const { zip_fclose(f); }
};
using Handle = std::unique_ptr<zip_t, Discard>;
using OpenEntry = std::unique_ptr<zip_file_t, Discard>;

Handle openHandle(const std::shared_ptr<const InputFile>& file) {
  auto state = std::make_unique<FileForZip>();
  state->file = file;
  zip_error_init(&state->error);
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_function_create(answer, state.get(), &error);
  if (!source) return nullptr;
  (void)state.release();  // freed by ZIP_SOURCE_FREE
  Handle handle(zip_open_from_source(source, ZIP_RDONLY, &error));
  if (!handle) zip_source_free(source);
  zip_error_fini(&error);
  return handle;
}

class ZipArchive final : public Archive, public std::enable_shared_from_this<ZipArchive> {
 public:
  ZipArchive(std::shared_ptr<const InputFile> file, std::string shown)
      : file_(std::move(file)), shown_(std::move(shown)) {}

  Result<void> list() {
    Handle handle = openHandle(file_);
    if (!handle)
      return makeError(
          ErrorCode::FileDamaged,
          "The ZIP archive cannot be read: it is cut short or its directory is damaged; fetch it again.",
          shown_);
    const zip_int64_t count = zip_get_num_entries(handle.get(), 0);
    if (const auto r = checkEntryCount(static_cast<std::uint64_t>(std::max<zip_int64_t>(count, 0)), shown_);
        !r)
      return r;
    ArchiveSizes sizes(file_->size());
    for (zip_int64_t n = 0; n < count; ++n) addEntry(*handle, static_cast<zip_uint64_t>(n), sizes);
    giveBack(std::move(handle));
    return {};
  }

  Result<std::unique_ptr<Reader>> reader(std::size_t entry) const override;
  void giveBack(Handle handle) const {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(handle));
  }

 private:
  void addEntry(zip_t& handle, zip_uint64_t n, ArchiveSizes& sizes) {
    zip_stat_t s;
    zip_stat_init(&s);
    const bool known =
        zip_stat_index(&handle, n, 0, &s) == 0 && (s.valid & ZIP_STAT_NAME) && (s.valid & ZIP_STAT_SIZE);
    EntryClaims claims;
    claims.name = known ? s.name : "";
    claims.bytes = known ? s.size : 0;
    claims.packedBytes = known && (s.valid & ZIP_STAT_COMP_SIZE) ? s.comp_size : 0;
    claims.encrypted = known && (s.valid & ZIP_STAT_ENCRYPTION_METHOD) && s.encryption_method != ZIP_EM_NONE;
    claims.readable =
        known && (!(s.valid & ZIP_STAT_COMP_METHOD) ||
                  zip_compression_method_supported(static_cast<zip_int32_t>(s.comp_method), 0) == 1);
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    if (zip_file_get_external_attributes(&handle, n, 0, &system, &attributes) == 0 &&
        system == ZIP_OPSYS_UNIX)
      claims.unixMode = attributes >> 16;
    if (auto entry = judgeEntry(claims, sizes)) {
      entries_.push_back(std::move(*entry));
      places_.push_back(n);
    }
  }

  std::shared_ptr<const InputFile> file_;
  std::string shown_;
  std::vector<zip_uint64_t> places_;  // of entries_ in the archive
  mutable std::mutex mutex_;
  mutable std::vector<Handle> idle_;
};

class ZipReader final : public Archive::Reader {
 public:
  ZipReader(std::shared_ptr<const ZipArchive> archive, Handle handle, OpenEntry file,
            const Archive::Entry& entry)
      : archive_(std::move(archive)), handle_(std::move(handle)), file_(std::move(file)), entry_(entry) {}
  ~ZipReader() override {
    file_.reset();
    archive_->giveBack(std::move(handle_));
  }
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  Result<std::size_t> read(std::span<std::byte> to) override {
    std::size_t got = 0;
    const std::size_t want =
        static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), entry_.bytes - done_));
    while (got < want) {
      const zip_int64_t n = zip_fread(file_.get(), to.data() + got, want - got);
      if (n <= 0) return damaged();
      got += static_cast<std::size_t>(n);
    }
    done_ += got;
    // The end is where the checksum is compared; a byte there is one too many.
    if (done_ == entry_.bytes && !ended_) {
      std::byte more;
      if (zip_fread(file_.get(), &more, 1) != 0) return damaged();
      ended_ = true;
    }
    return got;
  }

 private:
  Error damaged() const { return damagedEntry(lastPart(entry_.name)); }
  std::shared_ptr<const ZipArchive> archive_;
  Handle handle_;
  OpenEntry file_;
  const Archive::Entry& entry_;
  std::uint64_t done_ = 0;
  bool ended_ = false;
};

Result<std::unique_ptr<Archive::Reader>> ZipArchive::reader(std::size_t entry) const {
  const Entry& e = entries_.at(entry);
  if (e.error) return *e.error;
  Handle handle;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      handle = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!handle) handle = openHandle(file_);
  OpenEntry file(handle ? zip_fopen_index(handle.get(), places_[entry], 0) : nullptr);
  if (!file) return damagedEntry(lastPart(e.name));
  return std::unique_ptr<Reader>(
      std::make_unique<ZipReader>(shared_from_this(), std::move(handle), std::move(file), e));
}

}  // namespace

bool looksLikeArchive(std::span<const std::byte> head) {
  return head.size() >= 4 &&
         (std::memcmp(head.data(), "PK\3\4", 4) == 0 || std::memcmp(head.data(), "PK\5\6", 4) == 0);
}

Result<std::shared_ptr<const Archive>> Archive::open(std::shared_ptr<const InputFile> file,
                                                     const std::string& shown) {
  auto archive = std::make_shared<ZipArchive>(std::move(file), shown);
  if (auto r = archive->list(); !r) return r.error();
  return std::shared_ptr<const Archive>(std::move(archive));
}

Result<std::shared_ptr<const std::vector<std::byte>>> Archive::whole(std::size_t entry) const {
  Shared::Slot& slot = shared_->of(entry);
  const std::lock_guard lock(slot.mutex);
  if (auto there = slot.bytes.lock()) return there;
  auto from = reader(entry);
  if (!from) return from.error();
  // Grown as bytes come: what an entry declares sizes nothing.
  auto bytes = std::make_shared<std::vector<std::byte>>();
  for (std::size_t at = 0; at < entries_[entry].bytes || at == 0;) {
    bytes->resize(
        static_cast<std::size_t>(std::min<std::uint64_t>(entries_[entry].bytes, at + std::max(at, kPiece))));
    const auto n = (*from)->read(std::span(*bytes).subspan(at));
    if (!n) return n.error();
    if (*n == 0) break;
    at += *n;
  }
  std::shared_ptr<const std::vector<std::byte>> out = std::move(bytes);
  slot.bytes = out;
  return out;
}

}  // namespace vernier
