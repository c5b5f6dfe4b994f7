// Where something cuts a shell open: value, depth and z* of what the ray is inside of there.
uniform sampler2D caps;  // value, depth in mm, z*, weight 0: no cap
layout(location = 0) out vec4 crossing;

void main() {
  vec4 cap = texelFetch(caps, ivec2(gl_FragCoord.xy), 0);
  if (cap.a == 0.0) discard;
#ifdef Z_STAR
  gl_FragDepth = cap.z;
#endif
  crossing = vec4(cap.x, cap.y, 0.0, cap.a);
}
