// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/phantoms/Phantoms.h"

#include <atomic>
#include <fstream>
#include <mutex>
#include <system_error>

#include "Answers.h"
#include "DicomFile.h"
#include "MetaImage.h"
#include "MultiFrame.h"
#include "Plan.h"
#include "Recipes.h"
#include "Sample.h"
#include "Surface.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"

namespace vernier {

namespace phantoms {

std::optional<Json> findRecipe(const std::string& name) {
  for (const auto& [file, text] : embeddedRecipes()) {
    if (file != name) continue;
    Json recipe = Json::parse(text);
    if (!recipe.contains("base")) return recipe;
    std::optional<Json> base = findRecipe(recipe["base"].get<std::string>());
    if (!base) return std::nullopt;
    base->merge_patch(recipe);  // RFC 7386: objects are merged, anything else replaces, null removes
    base->erase("base");
    return base;
  }
  return std::nullopt;
}

namespace {

Result<void> makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder, error))
    return makeError(ErrorCode::WriteFailed,
                     "The output folder cannot be made; name one that can be written.",
                     folder.filename().string());
  return {};
}

Result<void> removeOldFiles(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_regular_file(error) && entry.path().extension() == ".dcm")
      std::filesystem::remove(entry.path(), error);
  if (error)
    return makeError(ErrorCode::WriteFailed,
                     "Files of an earlier run cannot be removed; name another folder.",
                     folder.filename().string());
  return {};
}

std::uint64_t filesIn(const std::filesystem::path& folder, std::uint64_t& bytes) {
  std::uint64_t files = 0;
  std::error_code ignored;
  bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".dcm") {
      ++files;
      bytes += entry.file_size(ignored);
    }
  return files;
}

// The fields of a recipe: of its source, or of its channels, each with a source of its own.
struct Channels {
  std::vector<std::unique_ptr<const Field>> owned;
  std::vector<const Field*> fields;
  std::vector<Solid> solids;  // of the first
};

Channels channelsOf(const Json& recipe, std::uint64_t seed) {
  Channels c;
  std::vector<Json> one{recipe};
  if (recipe.contains("channels")) {
    one.clear();
    for (const Json& source : recipe["channels"]) {
      one.push_back(recipe);
      one.back()["source"] = source;
    }
  }
  for (const Json& r : one) {
    const std::vector<Solid> solids = solidsOf(r, seed);
    if (c.owned.empty()) c.solids = solids;
    c.owned.push_back(makeField(r, seed, solids));
    c.fields.push_back(c.owned.back().get());
  }
  return c;
}

struct Job {
  const StudyPlan& study;
  const std::vector<const Field*>& fields;  // one, or red, green, blue and alpha
  std::filesystem::path folder;
  PhantomFormat format;
  const ProgressFn& progress;
  std::stop_token stop;
  std::vector<std::vector<SliceSums>> sums;
  std::vector<std::vector<std::int32_t>> frames;  // of multi-frame objects, by slice
  std::vector<std::int16_t> volume;               // MetaImage of one channel only
  std::vector<std::uint8_t> colours;              // MetaImage of several channels only, interleaved
  std::mutex mutex;
  std::optional<Error> failure;  // of the lowest file index, whatever the threads did
  std::size_t failedAt = 0;
  std::uint64_t done = 0, total = 0, bytes = 0;
};

Result<std::uint64_t> makeSlice(Job& job, std::size_t n, std::size_t k) {
  return guarded("phantom slice", [&]() -> Result<std::uint64_t> {
    const SeriesPlan& series = job.study.series[n];
    const SlicePlan& slice = series.slices[k];
    // DICOM's colours have no alpha.
    const bool meta = job.format == PhantomFormat::MetaImage;
    const std::size_t channels = meta ? job.fields.size() : static_cast<std::size_t>(series.samples);
    const std::vector<std::int32_t> stored =
        sampleChannels(job.fields, channels, series, slice, job.study.seed);
    job.sums[n][k] = sumsOf(stored);
    if (!series.objects.empty() && job.format == PhantomFormat::Dicom) {
      job.frames[k] = stored;  // written with the others of its object
      return 0;
    }
    if (meta && channels > 1) {
      std::copy(stored.begin(), stored.end(),
                job.colours.begin() + static_cast<std::ptrdiff_t>(k * stored.size()));
      return stored.size();
    }
    if (meta) {
      std::copy(stored.begin(), stored.end(),
                job.volume.begin() + static_cast<std::ptrdiff_t>(k * stored.size()));
      return stored.size() * 2;
    }
    const std::filesystem::path file = job.folder / slice.fileName;
    if (Result<void> written = writeDicom(job.study, series, slice, stored, file); !written)
      return written.error();
    std::error_code ignored;
    return std::filesystem::file_size(file, ignored);
  });
}

Result<void> makeSlices(Job& job) {
  std::vector<std::pair<std::size_t, std::size_t>> work;
  for (std::size_t n = 0; n < job.study.series.size(); ++n) {
    job.sums.emplace_back(job.study.series[n].slices.size());
    if (!job.study.series[n].objects.empty()) job.frames.resize(job.study.series[n].slices.size());
    for (std::size_t k = 0; k < job.study.series[n].slices.size(); ++k) work.emplace_back(n, k);
  }
  job.total = work.size();
  parallelFor(work.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t w = begin; w < end && !job.stop.stop_requested(); ++w) {
      const Result<std::uint64_t> bytes = makeSlice(job, work[w].first, work[w].second);
      const std::lock_guard lock(job.mutex);
      if (!bytes && (!job.failure || w < job.failedAt)) {
        job.failure = bytes.error();
        job.failedAt = w;
      }
      if (bytes) job.bytes += *bytes;
      ++job.done;
      if (job.progress) job.progress("phantom", job.done, job.total);
    }
  });
  if (job.failure) return *job.failure;
  if (job.stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Writing the phantom was cancelled.");
  return {};
}

// Multi-frame objects, and what lies beside the series; the answers of the latter.
Result<Json> writeMultiFrame(const Json& recipe, const std::string& variant, Job& job) {
  const SeriesPlan& series = job.study.series.front();
  for (std::size_t o = 0; o < series.objects.size(); ++o)
    if (Result<void> ok = writeEnhanced(job.study, series, o, job.frames, job.folder); !ok) return ok.error();
  return writeBeside(recipe, variant, job.study, job.folder);
}

Result<void> writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out)
    return makeError(ErrorCode::WriteFailed, "The answers cannot be written; check the folder and the disk.",
                     file.filename().string());
  return {};
}

Result<PhantomInfo> write(const std::string& name, const std::filesystem::path& outDir,
                          const PhantomOptions& options, const ProgressFn& progress) {
  const std::optional<Json> plain = findRecipe(name);
  if (!plain || !plain->contains("summary"))
    return makeError(ErrorCode::OptionInvalid, "There is no such phantom; 'vernier phantom list' names them.",
                     name);
  std::string variant;
  const Result<Json> recipe = applySettings(*plain, options.settings, variant);
  if (!recipe) return recipe.error();
  if (recipe->contains("surface")) {
    if (options.format == PhantomFormat::MetaImage)
      return makeError(ErrorCode::OptionInvalid,
                       "The phantom is a surface and is written as STL; leave the format out.", name);
    if (Result<void> made = makeFolder(outDir); !made) return made.error();
    return writeSurface(*recipe, outDir);
  }
  const StudyPlan study = makeStudyPlan(*recipe, variant);
  const Channels channels = channelsOf(*recipe, study.seed);

  const bool meta = options.format == PhantomFormat::MetaImage;
  PhantomInfo info;
  info.data = meta ? outDir / (name + ".mhd") : outDir / name;
  info.answers = outDir / (name + ".answers.json");
  if (meta) {
    if (Result<void> possible = canBeMetaImage(study); !possible) return possible.error();
  }
  if (Result<void> made = makeFolder(meta ? outDir : info.data); !made) return made.error();
  if (!meta) {
    if (Result<void> removed = removeOldFiles(info.data); !removed) return removed.error();
  }

  Job job{study,     channels.fields,
          info.data, options.format,
          progress,  options.stop,
          {},        {},
          {},        {},
          {},        {},
          0,         0,
          0,         0};
  if (meta) {
    const SeriesPlan& s = study.series.front();
    const std::size_t voxels = static_cast<std::size_t>(s.columns * s.rows) * s.slices.size();
    if (channels.fields.size() > 1)
      job.colours.resize(voxels * channels.fields.size());
    else
      job.volume.resize(voxels);
  }
  if (Result<void> made = makeSlices(job); !made) return made.error();
  if (meta) {
    const SeriesPlan& s = study.series.front();
    if (Result<void> w = job.colours.empty() ? writeMetaImage(s, job.volume, info.data)
                                             : writeMetaImage(s, job.colours, info.data);
        !w)
      return w.error();
  } else if (study.presentation) {
    const std::filesystem::path file = info.data / study.presentation->fileName;
    if (Result<void> w = writePresentation(study, *study.presentation, file); !w) return w.error();
  }
  Json beside;
  if (!meta) {
    Result<Json> made = writeMultiFrame(*recipe, variant, job);
    if (!made) return made.error();
    beside = std::move(*made);
  }
  Json answers = answersOf(*recipe, variant, study, channels.fields, channels.solids, job.sums);
  if (beside.is_object()) answers.update(beside);
  if (Result<void> w = writeText(info.answers, answers.dump(1) + "\n"); !w) return w.error();
  info.files = meta ? 2 : filesIn(info.data, info.bytes);
  if (meta) info.bytes = job.bytes;
  return info;
}

}  // namespace
}  // namespace phantoms

const std::vector<PhantomRecipe>& phantomRecipes() {
  static const std::vector<PhantomRecipe> all = [] {
    std::vector<PhantomRecipe> list;
    for (const auto& [name, text] : phantoms::embeddedRecipes()) {
      const std::optional<phantoms::Json> recipe = phantoms::findRecipe(name);
      PhantomRecipe r{name, recipe->at("summary"), {}, recipe->contains("surface")};
      const phantoms::Json settings = recipe->value("settings", phantoms::Json::object());
      for (const auto& item : settings.items())
        r.settings.push_back({item.key(), item.value().at("default"), item.value().at("about")});
      list.push_back(std::move(r));
    }
    return list;
  }();
  return all;
}

Result<PhantomInfo> writePhantom(const std::string& name, const std::filesystem::path& outDir,
                                 const PhantomOptions& options, const ProgressFn& progress) {
  return guarded("phantom " + name, [&] { return phantoms::write(name, outDir, options, progress); });
}

}  // namespace vernier
