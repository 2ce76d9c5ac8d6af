/* measure_main.c - parian-measure: methods and settings against ground truth.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

int main(void)
{
    fprintf(stderr, "parian-measure: not ready\n");
    return 5;
}
