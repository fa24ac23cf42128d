#pragma once

namespace springtower {

/// Height of the letters' line, pixels of a plain screen.
inline constexpr float kFont_px = 17.0F;

/// Sets font and sizes for a screen of this many pixels for one of a plain one, and a window of `windowScale` pixels for one of
/// its own units (1 on X11). A sans where the system has it, else Dear ImGui's own font. Precondition: a Dear ImGui context, no
/// frame begun.
void useStyle(float contentScale, float windowScale);

}  // namespace springtower
