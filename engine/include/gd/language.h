/* Language: marks the declarations of a header as C, for C++ programs. */
#ifndef GD_LANGUAGE_H
#define GD_LANGUAGE_H

#ifdef __cplusplus
#define GD_EXTERN_C_BEGIN extern "C" {
#define GD_EXTERN_C_END   }
#else
#define GD_EXTERN_C_BEGIN
#define GD_EXTERN_C_END
#endif

#endif
