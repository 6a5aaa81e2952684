/* From a multiboot loader's 32-bit mode to 64-bit Rust with every vector register enabled. */
.section .multiboot, "a"
.align 4
.long 0x1badb002, 0, -0x1badb002

.bss
.align 4096
level4: .skip 4096
level3: .skip 4096
level2: .skip 4096
.align 64
stack: .skip 8 << 20
stack_end:

.text
.code32
.globl start
start:
    cli
    mov $stack_end, %esp
    /* One gigabyte mapped to itself, in pages of two megabytes. */
    mov $level3 + 3, %eax
    mov %eax, level4
    mov $level2 + 3, %eax
    mov %eax, level3
    xor %ecx, %ecx
1:  mov %ecx, %eax
    shl $21, %eax
    or $0x83, %eax
    mov %eax, level2(, %ecx, 8)
    inc %ecx
    cmp $512, %ecx
    jne 1b
    mov $level4, %eax
    mov %eax, %cr3
    /* PAE, FXSR, SIMD exceptions, XSAVE. */
    mov %cr4, %eax
    or $0x40620, %eax
    mov %eax, %cr4
    /* Long mode. */
    mov $0xc0000080, %ecx
    rdmsr
    or $0x100, %eax
    wrmsr
    /* Paging, the coprocessor as it is. */
    mov %cr0, %eax
    and $~4, %eax
    or $0x80000002, %eax
    mov %eax, %cr0
    lgdt table_pointer
    ljmp $8, $long_mode

.code64
long_mode:
    mov $16, %eax
    mov %eax, %ds
    mov %eax, %es
    mov %eax, %ss
    /* x87, SSE, AVX, and the three parts of AVX-512 where the processor has them. */
    mov $0xd, %eax
    xor %ecx, %ecx
    cpuid
    and $0xe7, %eax
    xor %edx, %edx
    xor %ecx, %ecx
    xsetbv
    mov $stack_end, %rsp
    call srbf_bare_metal

.section .rodata
.align 8
table: .quad 0, 0x00af9a000000ffff, 0x00cf92000000ffff
table_pointer: .word 23
    .quad table

.section .note.GNU-stack, "", @progbits
