// SPDX-License-Identifier: GPL-3.0-or-later
// Inventor text ("#Inventor V2.1 ascii", and 2.0, 1.0), VRML 1.0 and VRML 2.0: coordinates and
// IndexedFaceSets in groups; in VRML 2.0 also Transform. Nodes that only colour, light or view are passed
// over. Any other node would change the shape: it is refused by its name.
#include <algorithm>
#include <map>
#include <memory>

#include <glm/gtc/matrix_transform.hpp>

#include "Readers.h"
#include "TextTokens.h"
#include "vernier/study/Limits.h"

namespace vernier::surface {
namespace {

using Points = std::vector<glm::dvec3>;

// Thrown inside this file only.
struct Refused {
  Error error;
};

constexpr std::string_view kPassedOver[] = {
    // Inventor and VRML 1.0
    "Material", "MaterialBinding", "BaseColor", "Normal", "NormalBinding", "Info", "Label", "LightModel",
    "DrawStyle", "Complexity", "TextureCoordinate2", "TextureCoordinateBinding", "Texture2", "Environment",
    "PerspectiveCamera", "OrthographicCamera", "DirectionalLight", "PointLight", "SpotLight", "PickStyle",
    // VRML 2.0
    "Appearance", "Background", "Color", "Fog", "NavigationInfo", "TextureCoordinate", "Viewpoint",
    "WorldInfo"};

bool passedOver(std::string_view name) {
  return std::find(std::begin(kPassedOver), std::end(kPassedOver), name) != std::end(kPassedOver);
}

struct State {
  std::shared_ptr<const Points> points;  // of Coordinate3
  bool clockwise = false;                // of ShapeHints
  glm::dmat4 worldFromHere{1.0};
};

class SceneGraphReader {
 public:
  SceneGraphReader(std::string_view bytes, bool vrml2, Polygons& out)
      : words_(bytes, "{}[]", '#'), vrml2_(vrml2), out_(out) {}

  void read() {
    State state;
    while (!words_.peek().empty()) readNode(state, 0);
  }

 private:
  [[noreturn]] void damaged(const std::string& sentence) const { throw Refused{words_.damaged(sentence)}; }
  [[noreturn]] void refused(std::string_view node) const {
    throw Refused{
        makeError(ErrorCode::NotBuiltYet,
                  "Line " + std::to_string(words_.line()) + ": the node " + shown(node) +
                      " is not read; only IndexedFaceSet in plain groups is: save the surface as such.")};
  }
  void open() {
    if (const std::string_view w = words_.next(); w != "{") damaged("'{' is expected, not " + shown(w) + ".");
  }
  bool closes() {
    const std::string_view w = words_.peek();
    if (w.empty()) damaged("The file ends inside a node; it is cut short.");
    if (w != "}") return false;
    (void)words_.next();
    return true;
  }

  // Reads "DEF name" when it stands here, gives the name.
  std::string defined() {
    if (words_.peek() != "DEF") return {};
    (void)words_.next();
    return std::string(words_.next());
  }

  // One node of a group.
  void readNode(State& state, int depth) {
    if (depth > limits::kMaxNodeDepth)
      damaged("Nodes are nested deeper than " + std::to_string(limits::kMaxNodeDepth) + ".");
    const std::string name = defined();
    const std::string_view node = words_.next();
    if (node == "USE") refused("USE " + std::string(words_.next()));
    if (node.empty()) damaged("A node is expected at the end of the file.");
    if (node == "Separator" || node == "TransformSeparator" || (node == "Group" && !vrml2_)) {
      open();
      State inner = state;
      while (!closes()) readNode(inner, depth + 1);
      if (node == "Group") state = inner;  // only separators keep what is inside to themselves
    } else if (vrml2_ && (node == "Group" || node == "Transform")) {
      readGroup2(state, node == "Transform", depth);
    } else if (vrml2_ && node == "Shape") {
      readShape(state);
    } else if (node == "Coordinate3" && !vrml2_) {
      state.points = readCoordinates();
    } else if (node == "IndexedFaceSet" && !vrml2_) {
      readFaces(state);
    } else if (node == "ShapeHints" && !vrml2_) {
      open();
      while (!closes())
        if (words_.next() == "vertexOrdering") state.clockwise = words_.next() == "CLOCKWISE";
    } else if (passedOver(node)) {
      skipNode();
    } else {
      refused(node);
    }
  }

  // --- VRML 2.0

  void readGroup2(const State& outer, bool transform, int depth) {
    State inner = outer;
    glm::dvec3 t(0), c(0), s(1);
    glm::dvec4 r(0, 0, 1, 0), so(0, 0, 1, 0);
    open();
    // The fields may stand after the children, so these are read last.
    std::optional<TextTokens> children;
    while (!closes()) {
      const std::string_view field = words_.next();
      if (field == "children") {
        if (children) damaged("A group has one list of children.");
        children = words_;
        skipValue();
      } else if (transform && (field == "translation" || field == "center" || field == "scale")) {
        const glm::dvec3 v = numbers<3>();
        (field == "translation" ? t : field == "center" ? c : s) = v;
      } else if (transform && (field == "rotation" || field == "scaleOrientation")) {
        (field == "rotation" ? r : so) = numbers<4>();
      } else {
        skipValue();
      }
    }
    if (!children) return;
    const glm::dmat4 one(1.0);
    inner.worldFromHere = outer.worldFromHere * glm::translate(one, t) * glm::translate(one, c) * turned(r) *
                          turned(so) * glm::scale(one, s) * glm::transpose(turned(so)) *
                          glm::translate(one, -c);
    const TextTokens after = std::exchange(words_, *children);
    if (words_.peek() == "[") {
      (void)words_.next();
      while (words_.peek() != "]") readNode(inner, depth + 1);
    } else {
      readNode(inner, depth + 1);
    }
    words_ = after;
  }

  static glm::dmat4 turned(glm::dvec4 axisAngle) {
    const glm::dvec3 axis(axisAngle);
    if (glm::dot(axis, axis) == 0) return glm::dmat4(1.0);
    return glm::rotate(glm::dmat4(1.0), axisAngle.w, glm::normalize(axis));
  }

  void readShape(const State& state) {
    open();
    while (!closes()) {
      if (words_.next() != "geometry") {
        skipValue();
        continue;
      }
      (void)defined();
      const std::string_view node = words_.next();
      if (node == "NULL") continue;
      if (node == "IndexedFaceSet")
        readFaces(state);
      else if (node == "IndexedLineSet" || node == "PointSet")
        skipNode();  // draw no surface
      else
        refused(node == "USE" ? "USE " + std::string(words_.next()) : std::string(node));
    }
  }

  // --- coordinates and faces

  template <int N>
  glm::vec<N, double> numbers() {
    glm::vec<N, double> v;
    for (int i = 0; i < N; ++i) {
      const std::string_view word = words_.next();
      const auto x = asNumber(word);
      if (!x) damaged("A number is expected, not " + shown(word) + ".");
      v[i] = *x;
    }
    return v;
  }

  std::shared_ptr<const Points> readCoordinates() {
    auto points = std::make_shared<Points>();
    open();
    while (!closes()) {
      const std::string_view field = words_.next();
      if (field != "point") damaged("The field " + shown(field) + " of coordinates is not known.");
      if (words_.peek() != "[") {
        points->push_back(numbers<3>());
        continue;
      }
      (void)words_.next();
      while (words_.peek() != "]") points->push_back(numbers<3>());
      (void)words_.next();
    }
    return points;
  }

  std::shared_ptr<const Points> coordField() {
    const std::string name = defined();
    const std::string_view node = words_.next();
    if (node == "NULL") return nullptr;
    if (node == "USE") {
      const auto known = named_.find(std::string(words_.next()));
      if (known == named_.end()) damaged("USE names coordinates that were not defined before.");
      return known->second;
    }
    if (node != "Coordinate") refused(node);
    auto points = readCoordinates();
    if (!name.empty()) named_[name] = points;
    return points;
  }

  std::vector<std::int64_t> indices() {
    std::vector<std::int64_t> out;
    const bool list = words_.peek() == "[";
    if (list) (void)words_.next();
    do {
      if (list && words_.peek() == "]") break;
      const std::string_view word = words_.next();
      const auto n = asInteger(word);
      if (!n || *n < -1 || *n > 0xFFFFFFFF)
        damaged("The number of a point or -1 is expected, not " + shown(word) + ".");
      out.push_back(*n);
    } while (list);
    if (list) (void)words_.next();
    return out;
  }

  void readFaces(const State& state) {
    std::shared_ptr<const Points> points = vrml2_ ? nullptr : state.points;
    bool clockwise = !vrml2_ && state.clockwise;
    std::vector<std::int64_t> index;
    open();
    while (!closes()) {
      const std::string_view field = words_.next();
      if (field == "coordIndex")
        index = indices();
      else if (field == "coord" && vrml2_)
        points = coordField();
      else if (field == "ccw" && vrml2_)
        clockwise = words_.next() == "FALSE";
      else if (field == "vertexProperty")
        refused("VertexProperty");
      else
        skipValue();
    }
    if (index.empty()) return;
    if (!points) damaged("The faces have no coordinates.");
    addFaces(*points, index, clockwise, state.worldFromHere);
  }

  void addFaces(const Points& points, const std::vector<std::int64_t>& index, bool clockwise,
                const glm::dmat4& m) {
    const bool moved = m != glm::dmat4(1.0);
    if (glm::determinant(glm::dmat3(m)) < 0) clockwise = !clockwise;  // a mirrored shape is turned inside out
    out_.startPoints();
    std::vector<std::uint32_t> face;
    const auto finish = [&] {
      if (clockwise) std::reverse(face.begin(), face.end());
      if (const Result<void> ok = out_.polygon(face); !ok) throw Refused{ok.error()};
      face.clear();
    };
    // Only points that are used are taken over, corner by corner: a short file may USE a long list very
    // often.
    for (const std::int64_t i : index) {
      if (i < 0) {
        finish();
        continue;
      }
      if (static_cast<std::size_t>(i) >= points.size())
        damaged("A face names point " + std::to_string(i) + ", but there are " +
                std::to_string(points.size()) + " points (counted from 0).");
      const glm::dvec3 p = points[static_cast<std::size_t>(i)];
      face.push_back(static_cast<std::uint32_t>(out_.points()));
      out_.point(moved ? glm::dvec3(m * glm::dvec4(p, 1.0)) : p);
    }
    finish();  // the last -1 may be left out
  }

  // --- what is passed over

  // To the brace or bracket that closes the one just read.
  void skipOpened() {
    for (int depth = 1; depth > 0;) {
      const std::string_view w = words_.next();
      if (w.empty()) damaged("The file ends inside a node; it is cut short.");
      if (w == "{" || w == "[") ++depth;
      if (w == "}" || w == "]") --depth;
    }
  }
  void skipNode() {
    open();
    skipOpened();
  }
  // A field's value: a list, a node, or the words up to the next name or brace.
  void skipValue() {
    (void)defined();
    const std::string_view first = words_.next();
    if (first == "[") return skipOpened();
    if (first == "USE") return (void)words_.next();
    if (words_.peek() == "{") return skipNode();
    while (asNumber(words_.peek())) (void)words_.next();
  }

  TextTokens words_;
  bool vrml2_;
  Polygons& out_;
  std::map<std::string, std::shared_ptr<const Points>> named_;
};

}  // namespace

Result<void> readSceneGraph(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  const std::string_view first = bytes.substr(0, std::min<std::size_t>(bytes.find_first_of("\r\n"), 80));
  const bool vrml2 = first.starts_with("#VRML V2.0 utf8");
  if (vrml2)
    file.format = "VRML 2.0";
  else if (first.starts_with("#VRML V1.0 ascii"))
    file.format = "VRML 1.0";
  else if (first.starts_with("#Inventor V") && first.find("ascii") != std::string_view::npos)
    file.format = "Inventor";
  else if (first.starts_with("#Inventor V"))
    return makeError(ErrorCode::NotBuiltYet,
                     "Only Inventor files in text are read; save this one as 'ascii'.");
  else
    return makeError(
        ErrorCode::FormatUnknown,
        "The first line names neither Inventor ('#Inventor V2.1 ascii') nor VRML ('#VRML V2.0 utf8').");
  try {
    SceneGraphReader(bytes, vrml2, out).read();
  } catch (const Refused& r) {
    return r.error;
  }
  return {};
}

}  // namespace vernier::surface
