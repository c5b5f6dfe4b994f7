// SPDX-License-Identifier: GPL-3.0-or-later
#include "ArchiveRules.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "vernier/study/Limits.h"

namespace vernier {
namespace {

std::string mib(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

// Absolute names of any system, and names that go up.
bool leadsOut(std::string_view name) {
  if (name.starts_with('/')) return true;
  if (name.size() >= 2 && name[1] == ':' && std::isalpha(static_cast<unsigned char>(name[0]))) return true;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    if (name.substr(at, end - at) == "..") return true;
    at = end + 1;
  }
  return false;
}

std::optional<Error> refusal(const EntryClaims& c) {
  const auto no = [](ErrorCode code, const char* sentence) { return makeError(code, sentence); };
  if (!c.readable)
    return no(
        ErrorCode::FormatUnknown,
        "The entry is packed in a way that is not read, or its description is damaged; pack it again with "
        "deflate.");
  if (leadsOut(c.name))
    return no(ErrorCode::FileDamaged,
              "The entry names a place outside the archive (an absolute path or \"..\") and is refused.");
  if (S_ISLNK(c.unixMode))
    return no(ErrorCode::NotAFile,
              "The entry is a symbolic link, which is not followed; pack the file itself.");
  if (c.unixMode != 0 && (c.unixMode & S_IFMT) != 0 && !S_ISREG(c.unixMode))
    return no(ErrorCode::NotAFile, "The entry is a device, pipe or socket and is refused.");
  if (c.encrypted)
    return no(ErrorCode::FormatUnknown,
              "The entry is encrypted; unpack the archive with its password and open the folder.");
  return std::nullopt;
}

}  // namespace

std::optional<Error> ArchiveSizes::add(std::uint64_t bytes, std::uint64_t packedBytes) {
  const auto beyond = [](const std::string& sentence) {
    return makeError(ErrorCode::LimitExceeded, sentence);
  };
  if (bytes > limits::kMaxArchiveEntryBytes)
    return beyond("The entry unpacks to " + mib(bytes) + ", more than the " +
                  mib(limits::kMaxArchiveEntryBytes) +
                  " that an entry may have; unpack the archive and open the folder.");
  const auto dense = [](std::uint64_t out, std::uint64_t in, std::uint64_t always) {
    return out > always && (in == 0 || out / in >= limits::kMaxArchiveRatio);
  };
  if (dense(bytes, packedBytes, limits::kArchiveEntryAlwaysBytes))
    return beyond("The entry grows more than " + std::to_string(limits::kMaxArchiveRatio) +
                  " times when it is unpacked, which no image does; it is refused.");
  // Entries that share their packed bytes are how a small archive pretends to hold much.
  if (packedBytes > archiveBytes_ - std::min(packed_, archiveBytes_))
    return beyond("The entries of the archive are longer than the archive itself; this one is refused.");
  if (bytes > limits::kMaxArchiveBytes - bytes_ ||
      dense(bytes_ + bytes, archiveBytes_, limits::kArchiveAlwaysBytes))
    return beyond("The archive unpacks to more than its limits allow (" + mib(limits::kMaxArchiveBytes) +
                  ", or " + std::to_string(limits::kMaxArchiveRatio) +
                  " times its size); this entry is refused.");
  bytes_ += bytes;
  packed_ += packedBytes;
  return std::nullopt;
}

Result<void> checkEntryCount(std::uint64_t count, const std::string& shown) {
  if (count <= limits::kMaxArchiveEntries) return {};
  return makeError(ErrorCode::LimitExceeded,
                   "The archive has " + std::to_string(count) + " entries, more than the " +
                       std::to_string(limits::kMaxArchiveEntries) +
                       " that are read; unpack it and open a folder of it.",
                   shown);
}

std::string lastPart(const std::string& name) { return name.substr(name.rfind('/') + 1); }

std::optional<Archive::Entry> judgeEntry(const EntryClaims& claims, ArchiveSizes& sizes) {
  EntryClaims c = claims;
  std::replace(c.name.begin(), c.name.end(), '\\', '/');  // as some tools of Windows write them
  if (c.name.ends_with('/') || S_ISDIR(c.unixMode)) return std::nullopt;
  Archive::Entry e;
  e.name = c.name;
  e.bytes = c.bytes;
  e.error = refusal(c);
  if (!e.error) e.error = sizes.add(c.bytes, c.packedBytes);
  if (e.error) e.error->where = lastPart(e.name);
  return e;
}

}  // namespace vernier
