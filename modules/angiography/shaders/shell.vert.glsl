// A shell or a tool. Positions in mm from the volume's middle. What is cut is cut at the place itself: only
// then z is replaced by z*, after the projection, so that nothing changes its size or its outline.
layout(location = 0) in vec3 position_mm;
uniform mat4 clipFromPlace;  // z: depth in mm along the view
uniform mat4 cuts0;          // four planes each, as columns: kept where the product is not negative
uniform mat4 cuts1;
uniform int perspective;
out float depth_mm;
out vec3 place_mm;
out float gl_ClipDistance[8];
uniform vec2 ramp;   // z' = ramp.x + ramp.y * (depth, or 1 / depth in perspective)
#ifdef Z_STAR
uniform vec2 zStar;  // z* = zStar.x + zStar.y * z', 0..1
#endif
#ifdef FOG
uniform vec2 fog;    // the share of full brightness that is left is fog.x + fog.y * z'
out float fogTimesW;
#endif

void main() {
  vec4 p = clipFromPlace * vec4(position_mm, 1.0);
  depth_mm = p.z;
  place_mm = position_mm;
  // z' is linear in the picture, so z' * w is linear in space: planes stay planes.
  float zw = perspective != 0 ? ramp.x * p.w + ramp.y : ramp.x + ramp.y * p.z;
#ifdef FOG
  fogTimesW = fog.x * p.w + fog.y * zw;
#endif
#ifdef Z_STAR
  p.z = 2.0 * (zStar.x * p.w + zStar.y * zw) - p.w;
#else
  p.z = 0.0;
#endif
  gl_Position = p;
  vec4 place = vec4(position_mm, 1.0);
  for (int n = 0; n < 4; ++n) {
    gl_ClipDistance[n] = dot(cuts0[n], place);
    gl_ClipDistance[n + 4] = dot(cuts1[n], place);
  }
}
