//! Builds nodes of the address space: objects and variables in the namespaces of the specifications, each with an id that
//! says where it is.

use opcua::nodes::{ObjectBuilder, VariableBuilder};
use opcua::server::address_space::AddressSpace;
use opcua::types::{Identifier, NodeId, QualifiedName, ReferenceTypeId, VariableTypeId, Variant};

use super::adapter_state::AdapterState;

/// Namespace of the machine and of what the companion specification has no place for.
pub const OWN_NAMESPACE: &str = "urn:kt830:machine";

/// A namespace of the specifications.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Namespace {
    /// OPC UA itself.
    Ua,
    /// Devices (OPC 10000-100).
    Devices,
    /// Machinery (OPC 40001-1).
    Machinery,
    /// Machine tools (OPC 40501-1).
    MachineTool,
    /// The machine.
    Own,
}

impl Namespace {
    /// All.
    pub const ALL: [Self; 5] = [Self::Ua, Self::Devices, Self::Machinery, Self::MachineTool, Self::Own];

    /// Its name.
    #[must_use]
    pub const fn uri(self) -> &'static str {
        match self {
            Self::Ua => "http://opcfoundation.org/UA/",
            Self::Devices => "http://opcfoundation.org/UA/DI/",
            Self::Machinery => "http://opcfoundation.org/UA/Machinery/",
            Self::MachineTool => "http://opcfoundation.org/UA/MachineTool/",
            Self::Own => OWN_NAMESPACE,
        }
    }
}

/// Index of each namespace in the server, in the order of [`Namespace::ALL`].
#[derive(Clone, Copy, Debug)]
pub struct NamespaceIndices(pub [u16; Namespace::ALL.len()]);

impl NamespaceIndices {
    /// The index of a namespace.
    #[must_use]
    pub const fn of(&self, namespace: Namespace) -> u16 {
        self.0[namespace as usize]
    }

    /// A node of a specification.
    #[must_use]
    pub fn node(&self, (namespace, number): TypeNumber) -> NodeId {
        NodeId::new(self.of(namespace), number)
    }
}

/// A node of a specification: its namespace and number.
pub type TypeNumber = (Namespace, u32);

/// How a variable is read from what the control tells; none where nothing is known.
pub type Read = Box<dyn Fn(&AdapterState) -> Option<Variant> + Send + Sync>;

/// A variable and how it is read.
pub struct BoundVariable {
    /// Its node.
    pub id: NodeId,
    /// How it is read.
    pub read: Read,
}

/// What kind of child an object or a variable is.
#[derive(Clone, Copy)]
pub enum ChildOf {
    /// A component.
    Component,
    /// A component with a place in a list.
    Ordered,
    /// A property.
    Property,
    /// An add-in.
    AddIn,
}

impl ChildOf {
    const fn reference(self) -> ReferenceTypeId {
        match self {
            Self::Component => ReferenceTypeId::HasComponent,
            Self::Ordered => ReferenceTypeId::HasOrderedComponent,
            Self::Property => ReferenceTypeId::HasProperty,
            Self::AddIn => ReferenceTypeId::HasAddIn,
        }
    }
}

/// A variable to be created.
pub struct VariableSpec {
    child: ChildOf,
    namespace: Namespace,
    name: &'static str,
    data_type: NodeId,
    kind: VariableTypeId,
}

impl VariableSpec {
    /// A variable of a type of data.
    pub fn new(child: ChildOf, namespace: Namespace, name: &'static str, data_type: impl Into<NodeId>) -> Self {
        let kind = match child {
            ChildOf::Property => VariableTypeId::PropertyType,
            ChildOf::Component | ChildOf::Ordered | ChildOf::AddIn => VariableTypeId::BaseDataVariableType,
        };
        Self { child, namespace, name, data_type: data_type.into(), kind }
    }

    /// The same, of another type of variables.
    #[must_use]
    pub fn of(self, kind: VariableTypeId) -> Self {
        Self { kind, ..self }
    }
}

/// The id of a node of the machine, which says where it is; empty for those of the specifications.
#[must_use]
pub fn path_of(node: &NodeId) -> &str {
    match &node.identifier {
        Identifier::String(path) => path.as_ref(),
        _ => "",
    }
}

/// Builds the nodes of a machine.
pub struct NodeBuilder<'a> {
    /// Where they stand.
    pub space: &'a mut AddressSpace,
    /// The namespaces.
    pub indices: NamespaceIndices,
    /// The variables that follow the control.
    pub variables: Vec<BoundVariable>,
}

impl NodeBuilder<'_> {
    /// The id of a child.
    pub fn child_id(&self, parent: &NodeId, name: &str) -> NodeId {
        NodeId::new(self.indices.of(Namespace::Own), format!("{}/{name}", path_of(parent)))
    }

    /// An object below another one.
    pub fn object(
        &mut self,
        parent: &NodeId,
        child: ChildOf,
        (namespace, name): (Namespace, &str),
        kind: TypeNumber,
    ) -> NodeId {
        let id = self.child_id(parent, name);
        ObjectBuilder::new(&id, QualifiedName::new(self.indices.of(namespace), name), name)
            .has_type_definition(self.indices.node(kind))
            .insert(self.space);
        self.space.insert_reference(parent, &id, child.reference());
        id
    }

    /// A component of the specification of machine tools.
    pub fn component(&mut self, parent: &NodeId, name: &str, kind: TypeNumber) -> NodeId {
        self.object(parent, ChildOf::Component, (Namespace::MachineTool, name), kind)
    }

    /// A variable that never changes.
    pub fn fixed(&mut self, parent: &NodeId, row: VariableSpec, value: impl Into<Variant>) -> NodeId {
        let id = self.child_id(parent, row.name);
        VariableBuilder::new(&id, QualifiedName::new(self.indices.of(row.namespace), row.name), row.name)
            .has_type_definition(row.kind)
            .data_type(row.data_type)
            .value(value)
            .insert(self.space);
        self.space.insert_reference(parent, &id, row.child.reference());
        id
    }

    /// A variable that follows the control.
    pub fn bound(
        &mut self,
        parent: &NodeId,
        row: VariableSpec,
        read: impl Fn(&AdapterState) -> Option<Variant> + Send + Sync + 'static,
    ) -> NodeId {
        let id = self.fixed(parent, row, Variant::Empty);
        self.variables.push(BoundVariable { id: id.clone(), read: Box::new(read) });
        id
    }
}
