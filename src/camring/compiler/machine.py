"""LLVM: from its text to machine code, and from that to something to call."""

import threading
from functools import lru_cache
from typing import Any

import llvmlite.binding as llvm

from camring.compiler.graph import NotInLanes

_one_at_a_time = threading.Lock()  # LLVM's own structures are shared in a process


def machine_code(text: str) -> bytes:
    """An object file for this processor.

    Raises
    ------
    NotInLanes
        Where LLVM does not know this processor, or not what the text asks of it.
    """
    with _one_at_a_time:
        try:
            module = llvm.parse_assembly(text)
            module.verify()
            machine = _machine()
            _tidy(module, machine)
            return machine.emit_object(module)
        except RuntimeError as problem:
            raise NotInLanes(f"LLVM: {problem}") from None


def _tidy(module: Any, machine: Any) -> None:
    """What of LLVM's passes makes these programs faster: the rest of `-O2` takes three times as
    long as writing the machine code does, and they run no faster for it (docs/notes/speed.md)."""
    passes = llvm.create_new_function_pass_manager()
    passes.add_sroa_pass()
    passes.add_instruction_combine_pass()
    passes.add_new_gvn_pass()
    passes.add_dead_store_elimination_pass()
    passes.add_instruction_combine_pass()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
    for function in module.functions:
        if not function.is_declaration:
            passes.run(function, builder)


def loaded(code: bytes) -> Any:
    """An object file ready to be called; keep it as long as anything of it is."""
    with _one_at_a_time:
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return engine


def _machine() -> Any:
    _begin()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features(), opt=3, jit=True
    )


@lru_cache(maxsize=1)
def _begin() -> None:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


@lru_cache(maxsize=1)
def features() -> str:
    """What this processor can do, in LLVM's words."""
    return llvm.get_host_cpu_features().flatten()


def has_wide_registers() -> bool:
    """Whether a register holds eight numbers of 64 bits."""
    return "+avx512f" in features().split(",")


def made_by() -> str:
    """Everything besides the text that machine code depends on."""
    return f"LLVM {llvm.llvm_version_info} {llvm.get_host_cpu_name()} {features()}"
