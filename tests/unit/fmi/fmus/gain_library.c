double gain_of_library(void);
double gain_of_library(void) { return 2.0; }
