// A ray cell by cell: between two faces the trilinear field is a cubic, whose turning points are known. Nothing is stepped
// over, whatever the lattice. Volumes with data in every voxel.
float cornerOfCell[8];

float voxelAt(ivec3 at) { return decoded(texelFetch(volume, at, 0).r); }

void readCell(ivec3 c) {
  for (int n = 0; n < 8; ++n) cornerOfCell[n] = voxelAt(c + ivec3(n & 1, (n >> 1) & 1, n >> 2));
}

float fieldInCell(vec3 q) {
  vec4 x = mix(vec4(cornerOfCell[0], cornerOfCell[2], cornerOfCell[4], cornerOfCell[6]),
               vec4(cornerOfCell[1], cornerOfCell[3], cornerOfCell[5], cornerOfCell[7]), q.x);
  vec2 y = mix(x.xz, x.yw, q.y);
  return mix(y.x, y.y, q.z);
}

// Where, between a and b of the cell, the field may turn: two shares of the way, ascending; 1 where it does not.
vec2 turningPoints(vec3 a, vec3 b) {
  float f0 = fieldInCell(a);
  float f1 = fieldInCell(mix(a, b, 1.0 / 3.0)) - f0;
  float f2 = fieldInCell(mix(a, b, 2.0 / 3.0)) - f0;
  float f3 = fieldInCell(b) - f0;
  float c1 = 0.5 * (18.0 * f1 - 9.0 * f2 + 2.0 * f3);
  float c2 = 0.5 * (-45.0 * f1 + 36.0 * f2 - 9.0 * f3);
  float c3 = 0.5 * (27.0 * f1 - 27.0 * f2 + 9.0 * f3);
  // c1 + 2 c2 u + 3 c3 u^2 = 0, by the root that does not cancel.
  float d = c2 * c2 - 3.0 * c1 * c3;
  if (d < 0.0) return vec2(1.0);
  float w = -(c2 + (c2 < 0.0 ? -1.0 : 1.0) * sqrt(d));
  float u = w != 0.0 ? c1 / w : 1.0;
  float v = c3 != 0.0 ? w / (3.0 * c3) : 1.0;
  u = u > 0.0 && u < 1.0 ? u : 1.0;
  v = v > 0.0 && v < 1.0 ? v : 1.0;
  return vec2(min(u, v), max(u, v));
}

// The walk: the cell, the face through which the ray leaves it next, on each axis.
struct Walk {
  ivec3 cell;
  float s;  // mm from the entry: where the ray enters the cell
};

vec3 facesAhead(Walk w, vec3 start, vec3 along) {
  vec3 next = vec3(1.0e30);
  for (int i = 0; i < 3; ++i)
    if (abs(along[i]) > 1.0e-12) next[i] = (float(w.cell[i]) + (along[i] > 0.0 ? 1.0 : 0.0) - start[i]) / along[i];
  return next;
}

Walk beginWalk(vec3 start) {
  return Walk(clamp(ivec3(floor(start)), ivec3(0), ivec3(last_vox) - 1), 0.0);
}

// To the next cell; false when the ray has left the volume.
bool nextCell(inout Walk w, vec3 next, vec3 along) {
  int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
  w.s = max(w.s, next[axis]);
  w.cell[axis] += along[axis] > 0.0 ? 1 : -1;
  return w.cell[axis] >= 0 && w.cell[axis] < int(last_vox[axis]);
}

vec3 inCell(Walk w, vec3 start, vec3 along, float s) {
  return clamp(start + s * along - vec3(w.cell), vec3(0.0), vec3(1.0));
}
