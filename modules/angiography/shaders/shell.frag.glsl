// One crossing: its value, and its depth.
in float depth_mm;
in vec3 place_mm;
uniform float phi;
#ifdef LIT
uniform float number;  // of the shell, from 1: its light comes from the field once the picture is read
#endif
#ifdef FOG
in float fogTimesW;
#endif
uniform vec4 eye_mm;  // w 1: the eye; w 0: the direction of view
#if defined(Z_STAR) && defined(BY_DISTANCE)
uniform vec2 zStar;  // distances are no planes after the projection: each fragment has its own z*
#endif
#ifdef TOOLS
uniform sampler2D toolEnd_mm;    // depth of the first opaque tool
uniform sampler2D toolLayers0;   // depth and alpha of two translucent layers each, nearest first
uniform sampler2D toolLayers1;
uniform sampler2D toolLayers2;
uniform sampler2D toolLayers3;
uniform sampler2D toolLayers4;

float past(vec4 two) {
  return (two.x < depth_mm ? 1.0 - two.y : 1.0) * (two.z < depth_mm ? 1.0 - two.w : 1.0);
}
#endif
#ifdef WINNER
uniform sampler2D greatest;  // brightness
#endif
layout(location = 0) out vec4 crossing;

void main() {
  float through = 1.0;
#ifdef TOOLS
  ivec2 at = ivec2(gl_FragCoord.xy);
  if (depth_mm >= texelFetch(toolEnd_mm, at, 0).r) discard;
  through = past(texelFetch(toolLayers0, at, 0)) * past(texelFetch(toolLayers1, at, 0)) *
            past(texelFetch(toolLayers2, at, 0)) * past(texelFetch(toolLayers3, at, 0)) *
            past(texelFetch(toolLayers4, at, 0));
#endif
#if defined(Z_STAR) && defined(BY_DISTANCE)
  gl_FragDepth = zStar.x + zStar.y * zPrime(depth_mm);
#endif
#ifdef WINNER
  // The nearest of the brightest: under the maximum, the one with the greatest negative depth.
  if (through * brightness(phi, depth_mm) < texelFetch(greatest, ivec2(gl_FragCoord.xy), 0).r - 1.0e-6) discard;
  crossing = vec4(-depth_mm, 0.0, 0.0, 1.0);
#elif defined(LIT)
  crossing = vec4(headlight(place_mm, eye_mm.w > 0.5 ? place_mm - eye_mm.xyz : eye_mm.xyz), depth_mm, number, 1.0);
#elif defined(FOG)
  // The paper's other way: full brightness, and a fog that is linear in the picture.
  crossing = vec4(through * (projected != 0 ? fogTimesW / depth_mm : fogTimesW), depth_mm, 0.0, 1.0);
#else
  crossing = vec4(through * brightness(phi, depth_mm), depth_mm, 0.0, 1.0);
#endif
}
