#include "normalshop/io/edit_report.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/options.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/io/atomic_file.h"

namespace normalshop {

namespace {

/// Turns the stages that Progress announces into times.
class StageClock {
 public:
  explicit StageClock(std::vector<std::pair<std::string, double>>& times) : times_(times) {}
  void start(std::string_view stage) {
    stop();
    const auto same = [&](const auto& t) { return t.first == stage; };
    const auto found = std::find_if(times_.begin(), times_.end(), same);
    current_ = static_cast<std::size_t>(found - times_.begin());
    if (found == times_.end()) times_.emplace_back(stage, 0.0);
  }
  void stop() {
    const double seconds = watch_.lap();
    if (current_ < times_.size()) times_[current_].second += seconds;
    current_ = times_.size() + 1;
  }

 private:
  std::vector<std::pair<std::string, double>>& times_;
  std::size_t current_ = std::size_t(-1);
  Stopwatch watch_;
};

std::vector<const NormalMap*> maps_of(const Document& document) {
  std::vector<const NormalMap*> maps;
  for (const StorageSet& set : document.storage().sets) maps.push_back(&set.normals);
  return maps;
}

std::vector<float> select(const std::vector<float>& all, const std::vector<std::uint32_t>& chosen) {
  std::vector<float> out;
  out.reserve(chosen.size());
  for (const std::uint32_t i : chosen) out.push_back(all[i]);
  return out;
}

/// More than this much of the radius of curvature is told: normals may be off by two degrees.
constexpr float high_relief = 0.07F;

void note_relief(const Edit& edit, const ReliefReach& relief, std::vector<std::string>& notes) {
  const std::string percent = std::to_string(std::lround(100.0F * relief.largest)) + " %";
  if (relief.folds) {
    notes.push_back(
        edit.path +
        ": its relief passes the surface's centre of curvature, where the surface would "
        "fold; make it lower");
  } else if (relief.largest > high_relief && edit.curvature == CurvatureRule::Drop) {
    notes.push_back(edit.path + ": its relief is as high as " + percent +
                    " of the surface's radius of curvature; \"curvature\": \"keep\" makes its "
                    "normals right");
  } else if (relief.largest > high_relief) {
    notes.push_back(edit.path + ": its relief is as high as " + percent +
                    " of the surface's radius of curvature, more than the 7 % up to which its "
                    "normals are known to be right");
  }
}

void note_shared(const Edit& edit, const PushResult& pushed, std::vector<std::string>& notes) {
  if (pushed.shared == 0) return;
  const std::string part = pushed.shared == pushed.changed ? "all" : std::to_string(pushed.shared);
  notes.push_back(edit.path + ": " + part + " of its " + std::to_string(pushed.changed) +
                  " texels lie under other triangles too (overlapping or mirrored charts), so that "
                  "the model changes there as well");
}

void apply_all(EditJob& job, const Recipe& recipe, StageClock& clock) {
  Document& document = job.opened.document;
  clock.start("seams");
  const std::vector<const NormalMap*> maps = maps_of(document);
  const std::vector<SeamSample> samples = sample_seams(document.mesh(), document.seams(), maps);
  const std::vector<float> before = seam_angles(document.mesh(), samples, maps);
  clock.start("edits");
  for (const Edit& edit : recipe.edits) {
    job.edits.push_back(document.apply(edit, job.transfer));
    note_edit(edit, job.edits.back(), job.notes);
  }
  clock.start("seams");
  const std::vector<float> after = seam_angles(document.mesh(), samples, maps);
  const std::vector<std::uint32_t> crossed = edited_samples(document.mesh(), samples, maps);
  job.seams_before = summarize(select(before, crossed));
  job.seams_after = summarize(select(after, crossed));
  job.seams_growth = mismatch_growth(before, after, crossed);
  clock.stop();
}

Value mismatch_value(const SeamMismatch& m) {
  return Value::Object{{"mean", m.mean}, {"median", m.p50}, {"p99", m.p99}, {"largest", m.max}};
}

Value sets_value(const EditJob& job) {
  Value::Array out;
  for (std::size_t i = 0; i < job.opened.sets.size(); ++i) {
    const OpenedSet& set = job.opened.sets[i];
    const NormalMap& map = job.opened.document.storage().sets[i].normals;
    Value::Object fields{{"name", job.opened.model.texture_sets[i].name},
                         {"normal_map", set.normal_map},
                         {"size", Value::Array{map.width(), map.height()}},
                         {"imported_size", Value::Array{set.imported_width, set.imported_height}},
                         {"bits", name_of(set.type)},
                         {"space", name_of(map.convention().space)},
                         {"green", map.convention().green_down ? "down" : "up"},
                         {"texels_edited", map.edited_count()}};
    if (set.guess) {
      fields.emplace_back("space_confidence", set.guess->space_confidence);
      fields.emplace_back("green_confidence", set.guess->green_confidence);
    }
    out.emplace_back(std::move(fields));
  }
  return out;
}

}  // namespace

void note_edit(const Edit& edit, const EditReport& report, std::vector<std::string>& notes) {
  note_relief(edit, report.relief, notes);
  note_shared(edit, report.pushed, notes);
  if (report.coarser_than_texels()) {
    notes.push_back(edit.path +
                    ": covers more texels than an editing chart has pixels, which are " +
                    std::to_string(std::lround(100.0F * (report.texels_per_pixel - 1.0F))) +
                    " % longer than the finest texels, so it comes out softer than the map could "
                    "show; edit from nearer");
  }
}

Value edits_value(std::span<const Edit> log, std::span<const EditReport> reports) {
  Value::Array out;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const EditReport& e = reports[i];
    out.push_back(Value::Object{{"operator", log[i].operation->name()},
                                {"texels_changed", e.pushed.changed},
                                {"texels_shared", e.pushed.shared},
                                {"largest_change_degrees", e.pushed.largest_change},
                                {"colors_changed", e.colors_changed},
                                {"largest_height_over_radius", e.relief.largest},
                                {"passes_centre_of_curvature", e.relief.folds},
                                {"views", e.views},
                                {"chart", Value::Array{e.chart_width, e.chart_height}},
                                {"pixel", e.pixel},
                                {"tiles", e.tiles},
                                {"coarser_than_texels", e.coarser_than_texels()},
                                {"texels_per_pixel", e.texels_per_pixel},
                                {"seconds", Value::Object{{"pull", e.times.pull},
                                                          {"operator", e.times.operate},
                                                          {"push", e.times.push}}}});
  }
  return out;
}

EditJob run_edit_job(const OpenOptions& open, const Recipe& recipe,
                     const std::filesystem::path& folder, const ExportOptions& options,
                     const TransferOptions& transfer) {
  // First, so that a folder that cannot be written costs no time.
  check_output_folder(open.model, folder);
  StagedFolder staged(folder);
  std::vector<std::pair<std::string, double>> times;
  StageClock clock(times);
  Progress progress;
  progress.report = [&](double, std::string_view stage) {
    clock.start(stage);
    return true;
  };
  EditJob job{open_document(open, progress), {}, transfer, {}, {}, {}, {}, {}, {}};
  clock.stop();
  job.notes = job.opened.notes;
  apply_all(job, recipe, clock);
  job.files = export_document(job.opened, staged, options, job.notes, progress);
  clock.stop();
  job.times = std::move(times);
  job.files.push_back(staged.path() / "report.json");
  staged.write([&] { write_file(job.files.back(), to_json(report_value(job))); });
  job.files = staged.commit(job.files);
  return job;
}

Value report_value(const EditJob& job) {
  Value::Array files;
  // The report is the last of them, in the folder itself.
  const std::filesystem::path folder =
      job.files.empty() ? std::filesystem::path() : job.files.back().parent_path();
  for (const auto& file : job.files) {
    files.emplace_back(file.lexically_relative(folder).generic_string());
  }
  Value::Array notes;
  for (const std::string& note : job.notes) notes.emplace_back(note);
  Value::Object times;
  for (const auto& [stage, seconds] : job.times) times.emplace_back(stage, seconds);
  std::size_t changed = 0;
  std::size_t lost = 0;
  float largest = 0.0F;
  for (const EditReport& e : job.edits) {
    largest = std::max(largest, e.pushed.largest_change);
    lost += e.lost;
  }
  for (const StorageSet& set : job.opened.document.storage().sets) {
    changed += set.normals.edited_count();
  }
  return Value::Object{
      {"model", job.opened.model.path.filename().string()},
      {"texels_changed", changed},
      {"largest_change_degrees", largest},
      {"transfer", name_of(job.transfer.transfer)},
      {"update", name_of(job.transfer.update)},
      {"texels_lost", lost},
      {"seams", Value::Object{{"samples", job.seams_growth.count},
                              {"before_degrees", mismatch_value(job.seams_before)},
                              {"after_degrees", mismatch_value(job.seams_after)},
                              {"growth_degrees", mismatch_value(job.seams_growth)}}},
      {"texture_sets", sets_value(job)},
      {"edits", edits_value(job.opened.document.log(), job.edits)},
      {"seconds", times},
      {"files", files},
      {"notes", notes}};
}

}  // namespace normalshop
