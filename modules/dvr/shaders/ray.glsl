// The ray of a pixel, counted from where it gets in: floats hold small numbers well. Lengths in mm, positions in voxels
// (centres at whole numbers).
uniform sampler2D rayStart;    // position of the entry; length to the exit
uniform sampler2D rayLattice;  // first sample in steps from the entry, its number, steps, what is left of light
uniform vec2 size_px;
uniform float pixelStep;       // mm per pixel at a depth of one mm; 0 in orthographic views
uniform vec3 forward_vox;      // along the view, voxels per mm
uniform vec3 right_vox;        // what one pixel adds to it in perspective
uniform vec3 down_vox;
uniform vec3 last_vox;         // of the box of voxel centres
uniform float step_mm;

vec2 fromMiddle_px() { return pixelStep > 0.0 ? gl_FragCoord.xy - 0.5 * size_px : vec2(0.0); }

// Distance along the ray for one mm along the view.
float perDepth() { return length(vec3(pixelStep * fromMiddle_px(), 1.0)); }

vec3 alongRay() {
  vec2 q = fromMiddle_px();
  return (forward_vox + q.x * right_vox + q.y * down_vox) / perDepth();
}

vec3 positionAt(vec4 start, vec3 along, float s) { return clamp(start.xyz + s * along, vec3(0.0), last_vox); }

// The share of the piece [from, to] of a ray that lies within its length.
float shareOf(float from, float to, float length_mm) {
  if (from >= 0.0 && to <= length_mm) return 1.0;
  return max(0.0, min(to, length_mm) - max(from, 0.0)) / (to - from);
}
