"""What a designer takes home: files for CAD, grinding machine, spreadsheet and workshop."""

from camring.interfaces.export.products import PRODUCTS, Wishes, chosen_products, export

__all__ = ["PRODUCTS", "Wishes", "chosen_products", "export"]
