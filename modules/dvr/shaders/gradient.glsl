// Central differences of the trilinear field, on the fly (plan/Scene.h), in the patient.
uniform mat4 gradientToPatient;

float besides(vec3 p, float own) {
  vec2 v = fieldAt(clamp(p, vec3(0.0), last_vox));
  return v.y > 0.0 ? v.x : own;
}

vec3 gradientAt(vec3 p, float own) {
  vec3 d = vec3(besides(p + vec3(1, 0, 0), own) - besides(p - vec3(1, 0, 0), own),
                besides(p + vec3(0, 1, 0), own) - besides(p - vec3(0, 1, 0), own),
                besides(p + vec3(0, 0, 1), own) - besides(p - vec3(0, 0, 1), own));
  return mat3(gradientToPatient) * (0.5 * d);
}
