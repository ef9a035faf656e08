#include "normalshop/core/error.h"
#include "normalshop/document/edit.h"
#include "normalshop/document/option_values.h"
#include "normalshop/document/part_fields.h"

namespace normalshop {

namespace {

constexpr double smallest_extent = 1e-9;
constexpr double largest_extent = 1e9;

float extent_field(const FieldReader& reader, std::string_view name) {
  return static_cast<float>(reader.required(name).number(smallest_extent, largest_extent));
}

Vec3f direction_field(const FieldReader& reader) {
  Vec3f v = reader.vec3();
  if (v.norm() < 1e-6F) reader.fail("a direction [x, y, z] of a length of at least 1e-6");
  return v;
}

constexpr std::string_view surface_name = "surface";
constexpr int most_views = 96;

ViewSpec read_view(const FieldReader& reader) {
  std::vector<std::string_view> names = names_list<NamedView>();
  names.push_back(surface_name);
  if (reader.value().text() != nullptr) {
    const std::size_t name = reader.one_of(names);
    if (names[name] == surface_name) return SurfaceView{};
    return static_cast<NamedView>(name);
  }
  if (reader.value().object() == nullptr) {
    reader.fail(join_names(names) + ", or an object with \"direction\", \"facing\" or \"surface\"");
  }
  if (reader.has(surface_name)) {
    reader.only({surface_name});
    const FieldReader surface = reader.required(surface_name);
    if (surface.value().object() == nullptr) surface.fail("an object with \"views\", 1 to 96");
    surface.only({"views"});
    return SurfaceView{surface.required("views").whole_number(1, most_views)};
  }
  if (reader.has("facing")) {
    reader.only({"facing", "width", "height"});
    FacingView view;
    view.point = reader.required("facing").vec3();
    view.width = extent_field(reader, "width");
    if (reader.has("height")) view.height = extent_field(reader, "height");
    return view;
  }
  reader.only({"direction", "up", "center", "width", "height"});
  FreeView view;
  view.direction = direction_field(reader.required("direction"));
  if (reader.has("up")) view.up = direction_field(reader.required("up"));
  if (reader.has("center")) view.center = reader.required("center").vec3();
  if (reader.has("width") || view.center) view.width = extent_field(reader, "width");
  if (reader.has("height")) view.height = extent_field(reader, "height");
  return view;
}

float coordinate(const FieldReader& reader) {
  return static_cast<float>(reader.number(-largest_extent, largest_extent));
}

UnitPoint read_point(const FieldReader& reader) {
  const Value::Array* array = reader.value().array();
  if (array == nullptr || (array->size() != 2 && array->size() != 3)) {
    reader.fail("[x, y] or [x, y, pressure]");
  }
  const std::vector<FieldReader> items = reader.items();
  UnitPoint point;
  point.position = {coordinate(items[0]), coordinate(items[1])};
  if (items.size() == 3) point.pressure = static_cast<float>(items[2].number(0.0, 1.0));
  return point;
}

SurfaceStrokePoint read_surface_point(const FieldReader& reader) {
  const Value::Array* array = reader.value().array();
  if (array == nullptr || (array->size() != 3 && array->size() != 4)) {
    reader.fail("[x, y, z] or [x, y, z, pressure] where the view is \"surface\"");
  }
  const std::vector<FieldReader> items = reader.items();
  SurfaceStrokePoint point{{coordinate(items[0]), coordinate(items[1]), coordinate(items[2])}};
  if (items.size() == 4) point.pressure = static_cast<float>(items[3].number(0.0, 1.0));
  return point;
}

/// Lists of at least one point each, which read(reader) reads.
template <class Read>
auto read_strokes(const FieldReader& reader, const Read& read) {
  using List = std::vector<decltype(read(reader))>;
  std::vector<List> strokes;
  for (const FieldReader& item : reader.items()) {
    List stroke;
    for (const FieldReader& point : item.items()) stroke.push_back(read(point));
    if (stroke.empty()) item.fail("a list of at least one point");
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

/// The second angle is at most `most` degrees.
EffectiveAngles read_angles(const FieldReader& reader, int most) {
  reader.only({"full", "zero"});
  EffectiveAngles angles;
  const auto angle = [&](const char* name, int low, int high, float& value) {
    if (reader.has(name)) value = static_cast<float>(reader.required(name).number(low, high));
  };
  angle("full", 0, most - 1, angles.full);
  angle("zero", 1, most, angles.zero);
  if (angles.full >= angles.zero) {
    throw InvalidInput(reader.path() + ".full must be below zero, which is " +
                       to_line(Value(angles.zero)) + " degrees");
  }
  return angles;
}

std::shared_ptr<const EditOperator> read_operator(const FieldReader& reader, Assets& assets) {
  std::vector<std::string_view> names;
  for (const OperatorType& type : operator_types()) names.push_back(type.name);
  const OperatorType& type = operator_types()[reader.required("operator").one_of(names)];
  const Value no_options = Value::Object{};
  const FieldReader options = reader.has("options")
                                  ? reader.required("options")
                                  : FieldReader(no_options, reader.path() + ".options");
  std::shared_ptr<EditOperator> operation = type.make(options);
  try {
    operation->load(assets);
  } catch (const Error& e) {
    const std::string field(operation->asset_field());
    throw InvalidInput(options.path() + (field.empty() ? "" : "." + field) + ": " + e.what());
  }
  return operation;
}

MirrorPlane read_mirror(const FieldReader& reader) {
  const bool named = reader.value().text() != nullptr;
  if (!named && reader.value().object() == nullptr) {
    reader.fail(join_names(names_list<Axis>()) + ", or an object with \"axis\" and \"at\"");
  }
  if (!named) reader.only({"axis", "at"});
  MirrorPlane plane;
  const FieldReader axis = named ? reader : reader.required("axis");
  plane.axis = static_cast<Axis>(axis.one_of(names_list<Axis>()));
  if (!named && reader.has("at")) plane.at = coordinate(reader.required("at"));
  return plane;
}

/// Planes of symmetry and most strokes are of one view.
void check_for_surface(const Edit& edit, const FieldReader& reader) {
  if (reader.has("mirror")) {
    reader.required("mirror").fail("left out where the view is \"surface\"");
  }
  if (edit.operation->follows_surface()) {
    std::vector<UnitStroke> counted;  // what operators ask for is how many there are
    for (const SurfaceStroke& stroke : edit.surface_strokes) {
      counted.emplace_back(stroke.size(), UnitPoint{Vec2f::Zero()});
    }
    edit.operation->check_strokes(counted, reader.path() + ".strokes");
    return;
  }
  try {
    edit.operation->check_strokes({}, "");
  } catch (const InvalidInput&) {
    reader.required("view").fail(join_names(names_list<NamedView>()) +
                                 ", or an object with \"direction\" or \"facing\", since \"" +
                                 std::string(edit.operation->name()) + "\" needs strokes here");
  }
  if (reader.has("strokes")) {
    reader.required("strokes").fail("left out where the view is \"surface\", since \"" +
                                    std::string(edit.operation->name()) +
                                    "\" with these options follows none there");
  }
}

void read_mode(const FieldReader& reader, Edit& edit) {
  const std::vector<std::string_view> names{name_of(EditMode::View), name_of(EditMode::Base)};
  if (reader.value().text() != nullptr) {
    edit.mode = static_cast<EditMode>(reader.one_of(names));
    return;
  }
  if (reader.value().object() == nullptr) {
    reader.fail(join_names(names) + ", or an object with \"along\"");
  }
  const std::string_view along = name_of(EditMode::Along);
  reader.only({along});
  edit.mode = EditMode::Along;
  edit.along = direction_field(reader.required(along));
}

Value mode_value(const Edit& edit) {
  if (edit.mode != EditMode::Along) return name_of(edit.mode);
  return Value::Object{{std::string(name_of(edit.mode)), vec3_value(edit.along)}};
}

Edit read_edit(const FieldReader& reader, Assets& assets) {
  reader.only({"operator", "view", "mode", "curvature", "details", "strength", "effective", "spray",
               "window", "options", "strokes", "mirror", "part", "comment"});
  Edit edit;
  edit.path = reader.path();
  edit.operation = read_operator(reader, assets);
  edit.view = read_view(reader.required("view"));
  // Several views have no direction in common.
  if (std::holds_alternative<SurfaceView>(edit.view)) edit.mode = EditMode::Base;
  if (reader.has("mode")) read_mode(reader.required("mode"), edit);
  if (reader.has("curvature")) {
    const FieldReader rule = reader.required("curvature");
    edit.curvature = static_cast<CurvatureRule>(rule.one_of(names_list<CurvatureRule>()));
    const bool keeps = edit.curvature == CurvatureRule::Keep;
    if (keeps && edit.mode != EditMode::Base) rule.fail("drop where the mode is not base");
  }
  if (reader.has("details")) {
    edit.details =
        static_cast<DetailsRule>(reader.required("details").one_of(names_list<DetailsRule>()));
  }
  if (reader.has("strength")) {
    edit.strength = static_cast<float>(reader.required("strength").number(0.0, 1.0));
  }
  if (reader.has("effective")) edit.effective = read_angles(reader.required("effective"), 86);
  if (reader.has("spray")) edit.spray = read_angles(reader.required("spray"), 90);
  if (reader.has("window")) {
    edit.window =
        static_cast<ChartWindow>(reader.required("window").one_of(names_list<ChartWindow>()));
  }
  const bool surface = std::holds_alternative<SurfaceView>(edit.view);
  if (reader.has("strokes") && !surface)
    edit.strokes = read_strokes(reader.required("strokes"), read_point);
  if (reader.has("strokes") && surface && edit.operation->follows_surface()) {
    edit.surface_strokes = read_strokes(reader.required("strokes"), read_surface_point);
  }
  if (reader.has("mirror")) edit.mirror = read_mirror(reader.required("mirror"));
  if (reader.has("part")) edit.part = read_part(reader.required("part"), surface, assets);
  edit.files = assets.take_files();
  if (surface) {
    check_for_surface(edit, reader);
  } else {
    edit.operation->check_strokes(edit.strokes, reader.path() + ".strokes");
  }
  return edit;
}

void add_extent(Value::Object& fields, float width, float height) {
  if (width > 0.0F) fields.emplace_back("width", width);
  if (height > 0.0F) fields.emplace_back("height", height);
}

Value view_value(const ViewSpec& spec) {
  if (const auto* named = std::get_if<NamedView>(&spec)) return name_of(*named);
  Value::Object fields;
  if (const auto* free = std::get_if<FreeView>(&spec)) {
    fields.emplace_back("direction", vec3_value(free->direction));
    fields.emplace_back("up", vec3_value(free->up));
    if (free->center) fields.emplace_back("center", vec3_value(*free->center));
    add_extent(fields, free->width, free->height);
  } else if (const auto* facing = std::get_if<FacingView>(&spec)) {
    fields.emplace_back("facing", vec3_value(facing->point));
    add_extent(fields, facing->width, facing->height);
  } else {
    const int views = std::get<SurfaceView>(spec).views;
    if (views == 0) return surface_name;
    fields.emplace_back(surface_name, Value::Object{{"views", views}});
  }
  return fields;
}

Value angles_value(const EffectiveAngles& angles) {
  return Value::Object{{"full", angles.full}, {"zero", angles.zero}};
}

Value strokes_value(const std::vector<UnitStroke>& strokes) {
  Value::Array out;
  for (const UnitStroke& stroke : strokes) {
    Value::Array points;
    for (const UnitPoint& p : stroke) {
      Value::Array point{p.position.x(), p.position.y()};
      if (p.pressure != 1.0F) point.emplace_back(p.pressure);
      points.emplace_back(std::move(point));
    }
    out.emplace_back(std::move(points));
  }
  return out;
}

Value surface_strokes_value(const std::vector<SurfaceStroke>& strokes) {
  Value::Array out;
  for (const SurfaceStroke& stroke : strokes) {
    Value::Array points;
    for (const SurfaceStrokePoint& p : stroke) {
      Value::Array point{p.position.x(), p.position.y(), p.position.z()};
      if (p.pressure != 1.0F) point.emplace_back(p.pressure);
      points.emplace_back(std::move(point));
    }
    out.emplace_back(std::move(points));
  }
  return out;
}

}  // namespace

Edit read_edit(const Value& edit, const std::string& path, Assets& assets) {
  return read_edit(FieldReader(edit, path), assets);
}

Recipe parse_recipe(std::string_view json, std::string_view file, Assets& assets) {
  const Value root = parse_json(json, file);
  const FieldReader reader(root, std::string(file) + ": ");
  reader.only({"version", "edits", "comment"});
  const FieldReader version = reader.required("version");
  if (version.number() != 1.0) version.fail("1, the version that this program reads");
  Recipe recipe;
  for (const FieldReader& item : reader.required("edits").items()) {
    recipe.edits.push_back(read_edit(item, assets));
  }
  return recipe;
}

Value to_value(const Recipe& recipe) {
  Value::Array edits;
  for (const Edit& edit : recipe.edits) {
    Value::Object fields{{"operator", edit.operation->name()},
                         {"view", view_value(edit.view)},
                         {"mode", mode_value(edit)},
                         {"curvature", name_of(edit.curvature)},
                         {"details", name_of(edit.details)},
                         {"strength", edit.strength},
                         {"effective", angles_value(edit.effective)},
                         {"window", name_of(edit.window)},
                         {"options", edit.operation->options()}};
    if (edit.spray) fields.emplace_back("spray", angles_value(*edit.spray));
    if (!edit.strokes.empty()) fields.emplace_back("strokes", strokes_value(edit.strokes));
    if (!edit.surface_strokes.empty()) {
      fields.emplace_back("strokes", surface_strokes_value(edit.surface_strokes));
    }
    if (edit.part) fields.emplace_back("part", part_value(*edit.part));
    if (edit.mirror) {
      fields.emplace_back(
          "mirror", Value::Object{{"axis", name_of(edit.mirror->axis)}, {"at", edit.mirror->at}});
    }
    edits.emplace_back(std::move(fields));
  }
  return Value::Object{{"version", 1}, {"edits", edits}};
}

}  // namespace normalshop
