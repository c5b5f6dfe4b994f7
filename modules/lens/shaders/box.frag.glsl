// bbox front and bbox back: where a line enters and leaves what takes part of the volume, closed by the near plane.
uniform float nearDepth;
layout(location = 0) out vec4 boxFront;
layout(location = 1) out vec4 boxBack;

void main() {
  Line line = lineOfPixel();
  vec2 span = within(line, vec2(nearDepth, 1.0e30));
  float there = span.x <= span.y ? 1.0 : 0.0;
  boxFront = there * vec4(pointAt(line, span.x), 1.0);
  boxBack = there * vec4(pointAt(line, span.y), 1.0);
}
