// SPDX-License-Identifier: GPL-3.0-or-later
// Finished pictures as textures of the window's context. Needs that context to be current; the only GL that
// the desktop speaks itself. Pixels are shown 1:1 and nothing of a picture is made here.
#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "vernier/picture/Picture.h"

namespace vernier::ui {

class Textures {
 public:
  ~Textures();
  // Fills the functions of the current context; false where one is missing.
  bool load();
  // The texture of `picture`, RGB or RGBA, uploaded when `number` differs from that of the last call for the
  // key. 0 for an empty picture.
  std::uint64_t get(const std::string& key, std::uint64_t number, const Picture& picture);
  // Frees those not asked for since the last call.
  void sweep();
  void clear();

  void beginFrame(int width_px, int height_px, float r, float g, float b);
  Picture readBack(int width_px, int height_px);  // of the framebuffer, RGB

 private:
  struct Texture {
    unsigned name = 0;
    std::uint64_t number = 0;
    int width = 0, height = 0;
    bool used = true;
  };
  std::map<std::string, Texture> all_;
};

}  // namespace vernier::ui
