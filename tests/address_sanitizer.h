#pragma once

// 1 where AddressSanitizer owns malloc; GCC and clang tell it in different ways.
#if defined(__SANITIZE_ADDRESS__)
#define CLOTH_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CLOTH_ADDRESS_SANITIZER 1
#endif
#endif
#ifndef CLOTH_ADDRESS_SANITIZER
#define CLOTH_ADDRESS_SANITIZER 0
#endif
