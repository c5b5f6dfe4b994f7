// SPDX-License-Identifier: GPL-3.0-or-later
#include "FileWalk.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "vernier/study/Archive.h"
#include "vernier/study/Files.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

class Walk {
 public:
  std::vector<FileRecord> files;
  bool tooMany = false, unpacks = true;

  void folder(const fs::path& named) {
    std::error_code ec;
    root_ = fs::canonical(named, ec);
    if (ec || !firstTime(named)) return;
    // A list of folders still to read instead of recursion: a tree may be deep.
    std::vector<std::pair<fs::path, std::string>> open{{named, ""}};
    while (!open.empty() && !tooMany) {
      const auto [path, shown] = open.back();
      open.pop_back();
      const std::size_t firstNew = open.size();
      std::vector<std::string> names;
      fs::directory_iterator it(path, ec);
      if (ec) {
        add(path, shown.empty() ? path.filename().string() : shown,
            makeError(ErrorCode::FileNotFound, "The folder cannot be read; check its permissions."));
        continue;
      }
      for (; it != fs::directory_iterator(); it.increment(ec)) {
        if (ec) break;
        names.push_back(it->path().filename().string());
      }
      std::sort(names.begin(), names.end());
      for (const std::string& name : names) {
        const fs::path p = path / name;
        const std::string s = shown.empty() ? name : shown + "/" + name;
        if (entry(p, s)) open.emplace_back(p, s);
      }
      std::reverse(open.begin() + static_cast<std::ptrdiff_t>(firstNew), open.end());
    }
  }

  void file(const fs::path& named, std::uint64_t bytes) {
    if (!firstTime(named)) return;
    add(named, named.filename().string());
    files.back().bytes = bytes;
    std::byte head[4];
    const auto input = openInput(files.back());
    if (unpacks && input && (*input)->read(0, head) && looksLikeArchive(head)) unpack(*input);
  }

 private:
  // The last file is an archive: its entries take its place.
  void unpack(const std::shared_ptr<const InputFile>& input) {
    const FileRecord named = files.back();
    auto archive = Archive::open(input, named.shown);
    if (!archive) {
      files.back().kind = FileKind::Unreadable;
      files.back().error = archive.error();
      return;
    }
    files.pop_back();
    for (std::size_t n = 0; n < (*archive)->entries().size(); ++n) {
      const Archive::Entry& e = (*archive)->entries()[n];
      add(named.path, e.name.substr(e.name.rfind('/') + 1), e.error);
      files.back().bytes = e.bytes;
      files.back().archive = *archive;
      files.back().entry = n;
    }
  }

  // True for a folder that is to be read.
  bool entry(const fs::path& p, const std::string& shown) {
    struct stat own {
    }, target{};
    if (::lstat(p.c_str(), &own) != 0 || ::stat(p.c_str(), &target) != 0) {
      add(p, shown,
          makeError(ErrorCode::FileNotFound, "The file or the place that a link names is not there."));
      return false;
    }
    if (S_ISLNK(own.st_mode) && !inside(p)) {
      add(p, shown,
          makeError(ErrorCode::NotAFile,
                    "The link leads out of the folder and was not followed; name its "
                    "target itself to load it."));
      return false;
    }
    if (S_ISDIR(target.st_mode)) return firstTime(p);
    if (!S_ISREG(target.st_mode)) {
      add(p, shown, makeError(ErrorCode::NotAFile, "This is a device, pipe or socket; it was not opened."));
      return false;
    }
    if (!firstTime(p)) return false;
    add(p, shown);
    files.back().bytes = static_cast<std::uint64_t>(target.st_size);
    return false;
  }
  bool inside(const fs::path& p) const {
    std::error_code ec;
    const fs::path target = fs::canonical(p, ec);
    if (ec) return false;
    const auto [r, t] = std::mismatch(root_.begin(), root_.end(), target.begin(), target.end());
    return r == root_.end();
  }
  bool firstTime(const fs::path& p) {
    struct stat s {};
    return ::stat(p.c_str(), &s) == 0 && seen_.emplace(s.st_dev, s.st_ino).second;
  }
  void add(const fs::path& p, const std::string& shown, std::optional<Error> error = {}) {
    FileRecord f;
    f.path = p.string();
    f.shown = shown;
    if (error) {
      f.kind = FileKind::Unreadable;
      error->where = shown;
      f.error = std::move(error);
    }
    files.push_back(std::move(f));
    tooMany = files.size() > limits::kMaxFilesPerStudy;
  }
  fs::path root_;
  std::set<std::pair<dev_t, ino_t>> seen_;
};

}  // namespace

Result<std::vector<FileRecord>> walkFiles(const std::vector<std::string>& paths, bool unpack) {
  Walk walk;
  walk.unpacks = unpack;
  for (const std::string& path : paths) {
    const std::string name = fs::path(path).filename().string();
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0)
      return makeError(ErrorCode::FileNotFound, "There is no such file or folder; check the name.", name);
    if (S_ISDIR(s.st_mode))
      walk.folder(path);
    else if (S_ISREG(s.st_mode))
      walk.file(path, static_cast<std::uint64_t>(s.st_size));
    else
      return makeError(ErrorCode::NotAFile, "This is a device, pipe or socket; name a file or a folder.",
                       name);
    if (walk.tooMany)
      return makeError(ErrorCode::LimitExceeded,
                       "There are more than " + std::to_string(limits::kMaxFilesPerStudy) +
                           " files; name a smaller folder.",
                       name);
  }
  return std::move(walk.files);
}

}  // namespace vernier
