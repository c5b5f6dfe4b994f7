// Polygons in picture coordinates (pixels, row 0 on top). Strips also carry the paper's alpha (0 on the first texture
// slice, 1 on the second) and texture coordinates in both slices; all are interpolated linearly (Gouraud).
layout(location = 0) in vec2 picture_px;
layout(location = 1) in float vertexAlpha;
layout(location = 2) in vec2 vertexUv0;
layout(location = 3) in vec2 vertexUv1;
uniform vec2 size_px;
out float gouraudAlpha;
out vec2 uv0;
out vec2 uv1;

void main() {
  gouraudAlpha = vertexAlpha;
  uv0 = vertexUv0;
  uv1 = vertexUv1;
  gl_Position = vec4(picture_px / size_px * 2.0 - 1.0, 0.0, 1.0);
}
