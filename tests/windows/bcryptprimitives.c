/* Rust's standard library takes its random numbers from bcryptprimitives.dll, which Wine has since version 9 only. This
 * stand-in for Wine 8 asks the older function behind RtlGenRandom. It is for the test alone: Windows has the real one. */

#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID buffer, ULONG length);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE buffer, SIZE_T length)
{
    while (length > 0) {
        ULONG part = length > 0x10000 ? 0x10000 : (ULONG)length;
        if (!SystemFunction036(buffer, part))
            return FALSE;
        buffer += part;
        length -= part;
    }
    return TRUE;
}
