// phi (beta0 + betaM (a z' + b)), z' of the fragment's own depth.
uniform int projected;   // z' by 1 / depth
uniform vec2 rampEnds_mm;  // near, far
uniform vec2 cue;        // beta0 + betaM b, betaM a

float zPrime(float depth) {
  float d = clamp(depth, rampEnds_mm.x, rampEnds_mm.y);
  float z = (rampEnds_mm.y - d) / (rampEnds_mm.y - rampEnds_mm.x);
  return projected != 0 ? z * rampEnds_mm.x / d : z;
}

float brightness(float phi, float depth) { return phi * (cue.x + (cue.y == 0.0 ? 0.0 : cue.y * zPrime(depth))); }

// The light of a surface: a headlight at the eye, by the triangle's own normal.
float headlight(vec3 place, vec3 ray) {
  vec3 normal = cross(dFdx(place), dFdy(place));
  return min(1.0, 0.2 + 0.8 * abs(dot(normal, ray)) / max(length(normal) * length(ray), 1e-30));
}
