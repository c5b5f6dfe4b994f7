// A batch of slices behind those that were drawn before. Blend: colour and what is left of light; the depth at which
// half of it is gone is that of the batch. Extremes: what was drawn is the greatest; the nearest sample of its batch.
uniform sampler2D frontSeen;
uniform sampler2D frontFound;
uniform sampler2D batchSeen;
uniform sampler2D batchFound;
uniform sampler2D rayLattice;
uniform int extreme;
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 front = texelFetch(frontSeen, at, 0);
  vec4 batch = texelFetch(batchSeen, at, 0);
  vec4 depth = texelFetch(batchFound, at, 0);
  seen = front;
  found = texelFetch(frontFound, at, 0);
  if (extreme != 0) {
    if (batch.a > 0.0 && (front.a <= 0.0 || batch.r > front.r)) found.x = -depth.x;
    seen = max(front, batch);
    return;
  }
  seen = vec4(front.rgb + front.a * batch.rgb, front.a * batch.a);
  float left = texelFetch(rayLattice, at, 0).w;
  if (found.x < 0.0 && left * seen.a <= 0.5 && batch.a < 1.0) found.x = max(0.0, depth.x / (1.0 - batch.a));
}
