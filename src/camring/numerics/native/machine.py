"""LLVM: from its text to machine code, and from that to something to call."""

import threading
from functools import lru_cache
from typing import Any

import llvmlite.binding as llvm

from camring.numerics.native.graph import NotInLanes

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
            tuning = llvm.create_pipeline_tuning_options(speed_level=2)
            tuning.loop_vectorization = tuning.slp_vectorization = False  # it is in lanes already
            passes = llvm.create_pass_builder(machine, tuning)
            passes.getModulePassManager().run(module, passes)
            return machine.emit_object(module)
        except RuntimeError as problem:
            raise NotInLanes(f"LLVM: {problem}") from None


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


def made_by() -> str:
    """Everything besides the text that machine code depends on."""
    return f"LLVM {llvm.llvm_version_info} {llvm.get_host_cpu_name()} {features()}"
