__declspec(dllexport) int gone(void);
int gone(void) { return 1; }
