// The line through a pixel and the convex bodies that it meets. Positions in mm from the middle (a point on the view's
// axis), depths along the view from the plane through it, so that floats keep their digits.
uniform vec3 right;        // mm per pixel on the plane through the middle
uniform vec3 down;
uniform vec3 forward;
uniform vec2 centre_px;
uniform float perDepth;    // what right and down grow by for each mm behind the plane; 0 in orthographic views
uniform sampler2D faces;   // of a body: outward normal, offset from the middle
uniform int faceCount;

struct Line {
  vec3 at;  // on the plane
  vec3 perMm;
};

Line lineOfPixel() {
  vec2 q = gl_FragCoord.xy - centre_px;
  vec3 across = q.x * right + q.y * down;
  return Line(across, forward + perDepth * across);
}

vec3 pointAt(Line line, float depth) { return line.at + depth * line.perMm; }
float depthOf(Line line, vec3 point) { return dot(point - line.at, line.perMm) / dot(line.perMm, line.perMm); }

// What of [span.x, span.y] lies in all half-spaces of the body; .x > .y: nothing.
vec2 within(Line line, vec2 span) {
  for (int n = 0; n < faceCount; ++n) {
    vec4 face = texelFetch(faces, ivec2(n, 0), 0);
    float along = dot(face.xyz, line.perMm);
    float before = face.w - dot(face.xyz, line.at);
    if (along < 0.0)
      span.x = max(span.x, before / along);
    else if (along > 0.0)
      span.y = min(span.y, before / along);
    else if (before < 0.0)
      return vec2(1.0e30, -1.0e30);
  }
  return span;
}
