#pragma once

// SPRINGTOWER_ADDRESS_SANITIZER is defined in builds with the address sanitizer, of which gcc and clang tell in different ways.
#if defined(__SANITIZE_ADDRESS__)
#define SPRINGTOWER_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SPRINGTOWER_ADDRESS_SANITIZER 1
#endif
#endif
