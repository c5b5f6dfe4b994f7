// Rezk-Salama 2000, equation 6, with coloured lights and a specular part (Material and Light of plan/Scene.h). All
// vectors unit, in the patient.
uniform vec4 material;       // ambient, diffuse, specular, power
uniform mat4 lightsTowards;  // a light in each column; w 1: far away there, 0: at the eye, -1: no more lights
uniform mat4 lightColours;
uniform vec4 forward_mm;     // of the view, in the patient
uniform vec4 right_mm;       // what one pixel adds to it in perspective
uniform vec4 down_mm;

vec3 towardsEye() {
  vec2 q = fromMiddle_px();
  return -normalize(forward_mm.xyz + q.x * right_mm.xyz + q.y * down_mm.xyz);
}

uniform float flat_perMm;     // gradients below this come from rounding

// n of length 0: no direction.
vec3 lit(vec3 ambientOwn, vec3 diffuseOwn, vec3 n, vec3 eye) {
  vec3 sum = material.x * ambientOwn;
  bool turned = dot(n, n) > 0.0;
  for (int i = 0; i < 4 && turned; ++i) {
    vec4 towards = lightsTowards[i];
    if (towards.w < 0.0) break;
    vec3 l = towards.w > 0.5 ? towards.xyz : eye;
    vec3 h = l + eye;
    float half_ = dot(h, h) > 0.0 ? max(0.0, dot(n, h) * inversesqrt(dot(h, h))) : 0.0;
    float shine = half_ > 0.0 ? material.z * pow(half_, material.w) : 0.0;
    sum += lightColours[i].rgb * (material.y * diffuseOwn * max(0.0, dot(n, l)) + shine);
  }
  return clamp(sum, 0.0, 1.0);
}

// Unit, turned to the eye; 0 where the field is flat.
vec3 normalOf(vec3 gradient, vec3 eye, float flat_) {
  float size = length(gradient);
  if (!(size > flat_)) return vec3(0.0);
  vec3 n = gradient / size;
  return dot(n, eye) < 0.0 ? -n : n;
}
